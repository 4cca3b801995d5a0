#include "server/engine/robot/odometry_noise.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

struct Variances {
  double translation;  // m², per axis
  double rotation;     // rad²
};

// At scale 1.
Variances base_variances(const Pose& step, const OdometryNoiseOptions& options) {
  const double way_m = std::hypot(step.x, step.y);
  const double turn_rad = std::abs(step.yaw);
  return {options.translation_per_m * way_m + options.translation_per_rad * turn_rad +
              options.translation_floor_m2,
          options.rotation_per_m * way_m + options.rotation_per_rad * turn_rad + options.rotation_floor_rad2};
}

}  // namespace

OdometryNoise::OdometryNoise(const OdometryNoiseOptions& options)
    : scale_{options.first_scale, options.first_scale}, path_variance_scale_(options.first_path_scale) {}

Eigen::Matrix3d OdometryNoise::covariance(const Pose& step, const OdometryNoiseOptions& options) const {
  const Variances base = base_variances(step, options);
  const double translation = base.translation * scale_[0] * scale_[0];
  const double rotation = base.rotation * scale_[1] * scale_[1];
  return Eigen::Vector3d(translation, translation, rotation).asDiagonal();
}

void OdometryNoise::learn(const Pose& odometry_step, const Pose& matched_step,
                          const Eigen::Matrix2d& direction_trust, const OdometryNoiseOptions& options,
                          const OdometryLearningOptions& learning) {
  // A robot at rest tells only how matching trembles.
  if (std::hypot(odometry_step.x, odometry_step.y) < learning.rest_m &&
      std::abs(odometry_step.yaw) < learning.rest_rad)
    return;
  const Variances base = base_variances(odometry_step, options);
  const double outlier = options.outlier_sigmas * options.outlier_sigmas;
  const auto update = [&](double& scale, double off, double base_variance) {
    const double variance = scale * scale;
    const double seen = std::min(off * off / base_variance, outlier * variance);
    scale = std::clamp(std::sqrt((1 - options.forgetting) * variance + options.forgetting * seen),
                       options.min_scale, options.max_scale);
  };
  update(scale_[1], wrap_angle(matched_step.yaw - odometry_step.yaw), base.rotation);
  const Eigen::Vector2d way = position(odometry_step);
  if (way.norm() < learning.rest_m) return;
  const Eigen::Vector2d along = way.normalized();
  if (along.dot(direction_trust * along) < learning.well_known) return;
  update(scale_[0], along.dot(position(matched_step) - way), base.translation);
}

Eigen::Matrix3d OdometryNoise::path_covariance(const Pose& odometry_path,
                                               const Eigen::Matrix3d& summed_covariance,
                                               const Pose& matched_path, bool well_seen,
                                               const OdometryNoiseOptions& options) {
  const Eigen::Vector3d off = wrapped_difference(matched_path, odometry_path);
  const Eigen::Vector2d off_way = off.head<2>();
  const double of_way = off_way.dot(summed_covariance.topLeftCorner<2, 2>().inverse() * off_way);
  const double of_turn = off.z() * off.z() / summed_covariance(2, 2);
  if (well_seen) {
    const double outlier = options.outlier_sigmas * options.outlier_sigmas;
    const double seen = std::min((of_way + of_turn) / 3, outlier * path_variance_scale_);
    path_variance_scale_ =
        std::max(options.min_path_scale,
                 (1 - options.path_forgetting) * path_variance_scale_ + options.path_forgetting * seen);
  }
  const auto factor = [&](double squared) {
    return std::sqrt(std::max(path_variance_scale_, squared / options.common.plausible.bound(3)));
  };
  const Eigen::Vector3d factors(factor(of_way), factor(of_way), factor(of_turn));
  return factors.asDiagonal() * summed_covariance * factors.asDiagonal();
}

}  // namespace isthmus
