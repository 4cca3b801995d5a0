#include "server/engine/robot/odometry_noise.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

// Variances at scale 1. They grow with the way, as those of a random walk do, from a floor of what encoders
// resolve.
struct Variances {
  double translation;  // m², per axis
  double rotation;     // rad²
};

Variances base_variances(const Pose& step) {
  const double way_m = std::hypot(step.x, step.y);
  const double turn_rad = std::abs(step.yaw);
  return {3.2e-4 * way_m + 1e-4 * turn_rad + 4e-6, 8e-5 * way_m + 5e-4 * turn_rad + 4e-6};
}

}  // namespace

Eigen::Matrix3d OdometryNoise::covariance(const Pose& step) const {
  const Variances base = base_variances(step);
  const double translation = base.translation * scale_[0] * scale_[0];
  const double rotation = base.rotation * scale_[1] * scale_[1];
  return Eigen::Vector3d(translation, translation, rotation).asDiagonal();
}

void OdometryNoise::learn(const Pose& odometry_step, const Pose& matched_step,
                          const Eigen::Matrix2d& direction_trust) {
  constexpr double forgetting = 0.005;
  constexpr double least = 0.3;
  constexpr double most = 20;
  constexpr double well_known = 0.8;
  // A robot at rest tells only how matching trembles.
  if (std::hypot(odometry_step.x, odometry_step.y) < 0.01 && std::abs(odometry_step.yaw) < 0.005) return;
  const Variances base = base_variances(odometry_step);
  const auto update = [&](double& scale, double off, double base_variance) {
    const double variance = scale * scale;
    const double seen = std::min(off * off / base_variance, 16 * variance);
    scale = std::clamp(std::sqrt((1 - forgetting) * variance + forgetting * seen), least, most);
  };
  update(scale_[1], wrap_angle(matched_step.yaw - odometry_step.yaw), base.rotation);
  const Eigen::Vector2d way(odometry_step.x, odometry_step.y);
  if (way.norm() < 0.01) return;
  const Eigen::Vector2d along = way.normalized();
  if (along.dot(direction_trust * along) < well_known) return;
  update(scale_[0], along.dot(Eigen::Vector2d(matched_step.x, matched_step.y) - way), base.translation);
}

Eigen::Matrix3d OdometryNoise::path_covariance(const Pose& odometry_path,
                                               const Eigen::Matrix3d& summed_covariance,
                                               const Pose& matched_path, bool well_seen) {
  constexpr double forgetting = 0.05;
  constexpr double plausible = 7.8;  // 95 % of chi² of three
  Eigen::Vector3d off = to_vector(matched_path) - to_vector(odometry_path);
  off.z() = wrap_angle(off.z());
  const double squared = off.dot(summed_covariance.inverse() * off);
  if (well_seen) {
    const double seen = std::min(squared / 3, 16 * path_variance_scale_);
    path_variance_scale_ = std::max(0.25, (1 - forgetting) * path_variance_scale_ + forgetting * seen);
  }
  return summed_covariance * std::max(path_variance_scale_, squared / plausible);
}

}  // namespace isthmus
