#include "server/engine/robot/odometry_bias.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

constexpr double usual_delay = 1;  // in standard deviations of robots at large

}  // namespace

Eigen::Matrix2d OdometryBias::Estimate::covariance(const Eigen::Vector2d& prior_sigmas) const {
  const Eigen::Matrix2d prior = prior_sigmas.cwiseAbs2().cwiseInverse().asDiagonal();
  return (information + prior).inverse();
}

void OdometryBias::Estimate::learn(const Eigen::Vector2d& regressor, double error, double variance,
                                   double kept, const Eigen::Vector2d& prior_sigmas, double outlier_sigmas) {
  // Huber's weight of what is left: a slip is no bias.
  const double off = std::abs(error - regressor.dot(value));
  const double bound = outlier_sigmas * std::sqrt(variance);
  const double weight = (off > bound ? bound / off : 1) / variance;
  information = kept * information + weight * regressor * regressor.transpose();
  sum = kept * sum + weight * error * regressor;
  value = covariance(prior_sigmas) * sum;
}

double OdometryBias::path_yaw_variance(const Pose& path, const OdometryBiasOptions& options) const {
  const Eigen::Vector2d together(remembered_m_ * position(path).norm(), remembered_rad_ * std::abs(path.yaw));
  return yaw_.covariance({options.turn_per_m_sigma, options.share_sigma}).diagonal().dot(together);
}

Pose OdometryBias::corrected(const Pose& step) const {
  const Eigen::Vector2d regressor(step.x, step.yaw);
  return {step.x + way_.value(0) * step.x, step.y + regressor.dot(aside_.value),
          wrap_angle(step.yaw + regressor.dot(yaw_.value))};
}

void OdometryBias::learn(const Pose& odometry_step, double farther_if_late_m, const Pose& matched_step,
                         const Eigen::Matrix3d& noise, const Eigen::Matrix2d& direction_trust,
                         const OdometryBiasOptions& options, const OdometryLearningOptions& learning) {
  const double way_m = std::abs(odometry_step.x);
  const double turn_rad = std::abs(odometry_step.yaw);
  // A robot at rest tells only how matching trembles.
  if (way_m < learning.rest_m && turn_rad < learning.rest_rad) return;
  const double kept = std::exp(-way_m / options.memory_m - turn_rad / options.memory_rad);
  remembered_m_ = kept * remembered_m_ + way_m;
  remembered_rad_ = kept * remembered_rad_ + turn_rad;
  const Eigen::Vector2d regressor(odometry_step.x, odometry_step.yaw);
  const double match_variance = options.match_sigma_m * options.match_sigma_m;
  yaw_.learn(regressor, wrap_angle(matched_step.yaw - odometry_step.yaw),
             noise(2, 2) + options.match_sigma_rad * options.match_sigma_rad, kept,
             {options.turn_per_m_sigma, options.share_sigma}, options.outlier_sigmas);
  if (direction_trust(1, 1) > learning.well_known)
    aside_.learn(regressor, matched_step.y - odometry_step.y, noise(1, 1) + match_variance, kept,
                 {options.share_sigma, options.share_sigma}, options.outlier_sigmas);
  if (direction_trust(0, 0) > learning.well_known)
    way_.learn({odometry_step.x, farther_if_late_m}, matched_step.x - odometry_step.x,
               noise(0, 0) + match_variance, kept, {options.share_sigma, usual_delay},
               options.outlier_sigmas);
}

}  // namespace isthmus
