#include "server/engine/map/drift.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus {

Eigen::Vector3d systematic_variance(double way_m, const PlaceCandidateOptions& options) {
  const double position = options.systematic_m + options.systematic_share * way_m;
  const double yaw = options.common.yaw_rad(options.systematic_m) + options.systematic_rad_per_m * way_m;
  return {position * position, position * position, yaw * yaw};
}

Eigen::Vector3d drift_variance(double way_m, const PlaceCandidateOptions& options) {
  const double position =
      (options.min_drift_m + options.drift_per_way * way_m) / options.common.window_sigmas;
  const double yaw = (options.common.yaw_rad(options.min_drift_m) + options.drift_rad_per_m * way_m) /
                     options.common.window_sigmas;
  return {position * position, position * position, yaw * yaw};
}

double log_search_window(double way_m, const PlaceCandidateOptions& options) {
  const Eigen::Vector3d half = options.common.window_sigmas * drift_variance(way_m, options).cwiseSqrt();
  return std::log(4 * half.x() * half.y() * 2 * std::min(std::numbers::pi, half.z()));
}

double drift_log_odds(const Pose& found, const Pose& mapped, const Eigen::Matrix3d& covariance, double way_m,
                      const PlaceCandidateOptions& options) {
  Eigen::Matrix3d errs = covariance;
  errs.diagonal() += systematic_variance(way_m, options);
  const Eigen::Vector3d off = wrapped_difference(found, mapped);
  const double log_density =
      -0.5 * (off.dot(errs.inverse() * off) +
              std::log(std::pow(2 * std::numbers::pi, off.size()) * errs.determinant()));
  return log_density + log_search_window(way_m, options);
}

double revisit_log_odds(const Pose& found, const Pose& mapped, const Eigen::Matrix3d& covariance,
                        double way_m, const PlaceCandidateOptions& options) {
  const double drifted = std::exp(drift_log_odds(found, mapped, covariance, way_m, options));
  return std::log((1 - options.slip_probability) * drifted + options.slip_probability);
}

}  // namespace isthmus
