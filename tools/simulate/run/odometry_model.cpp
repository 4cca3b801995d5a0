#include "tools/simulate/run/odometry_model.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {

OdometryModel::OdometryModel(const OdometryPlan& plan, Random random) : plan_(plan), random_(random) {
  linear_scale_ = plan_.linear_scale + random_.normal(plan_.linear_scale_sigma);
  angular_scale_ = plan_.angular_scale + random_.normal(plan_.angular_scale_sigma);
}

Pose OdometryModel::advance(const Pose& world_from_earlier, const Pose& world_from_later, double dt_s) {
  if (period_left_s_ <= 0) {
    linear_noise_ = random_.normal();
    angular_noise_ = random_.normal();
    period_left_s_ = std::max(0.0, period_left_s_ + plan_.noise_period_s);
  }
  period_left_s_ -= dt_s;

  const Pose moved = ominus(world_from_later, world_from_earlier);
  const double distance = std::hypot(moved.x, moved.y);
  if (distance < 1e-7 && std::abs(moved.yaw) < 1e-7) return odom_from_robot_;  // wheels at rest do not slip
  const double stretch = linear_scale_ + plan_.linear_share * linear_noise_;
  const double sigma_rps = plan_.angular_share * std::abs(moved.yaw) / dt_s + plan_.angular_floor_rps;
  const double yaw =
      angular_scale_ * moved.yaw + plan_.curvature_rpm * distance + sigma_rps * angular_noise_ * dt_s;
  odom_from_robot_ = odom_from_robot_ * Pose{stretch * moved.x, stretch * moved.y, yaw};
  return odom_from_robot_;
}

}  // namespace isthmus
