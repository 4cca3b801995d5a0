#include "tools/simulate/run/laser_model.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

using Eigen::Vector2d;

// The range at which a ray meets a disc from outside.
double ray_meets(const Vector2d& from, const Vector2d& direction, const Passerby& body) {
  const Vector2d to_centre = body.centre - from;
  const double along = to_centre.dot(direction);
  const double squared = body.radius_m * body.radius_m - (to_centre.squaredNorm() - along * along);
  if (along <= 0 || squared < 0 || to_centre.norm() <= body.radius_m) return no_hit_m;
  return along - std::sqrt(squared);
}

// The true range along a beam; infinite where nothing comes back. A body hides the wall behind it.
double true_range(const LaserPlan& plan, const RayCaster& caster, const Vector2d& from,
                  const Vector2d& direction, const std::vector<Passerby>& bodies) {
  double nearest_body = no_hit_m;
  for (const Passerby& body : bodies) nearest_body = std::min(nearest_body, ray_meets(from, direction, body));
  const auto hit = caster.cast(from, direction, plan.laser.range_max_m);
  if (!hit || nearest_body < hit->range_m) return nearest_body;
  const double limit = std::min(plan.return_limit_rad, hit->return_limit_rad);
  return hit->incidence_rad <= limit ? hit->range_m : no_hit_m;
}

}  // namespace

Laser declared_laser(const LaserPlan& plan) {
  Laser laser = plan.laser;
  if (plan.rate_hz <= 0) laser.range_min_m = laser.range_max_m = 0;
  laser.robot_from_laser = laser.robot_from_laser * plan.declared_mount_error;
  return laser;
}

Scan take_scan(const LaserPlan& plan, const RayCaster& caster, const Pose& world_from_robot,
               const std::vector<Passerby>& bodies, Random& random, double shift_rad) {
  const Pose world_from_laser = world_from_robot * plan.laser.robot_from_laser;
  const Vector2d from(world_from_laser.x, world_from_laser.y);
  Scan scan;
  scan.bearing0_rad = -0.5 * plan.field_of_view_rad;
  scan.bearing_step_rad = plan.beams > 1 ? plan.field_of_view_rad / (plan.beams - 1) : 0;
  if (plan.beams == 1) scan.bearing0_rad = 0;
  scan.bearing0_rad += shift_rad;
  const auto nothing = static_cast<float>(plan.no_return_is_infinite ? no_hit_m : plan.laser.range_max_m);
  for (int i = 0; i < plan.beams; ++i) {
    const double bearing =
        scan.bearing0_rad + i * scan.bearing_step_rad + random.normal(plan.bearing_sigma_rad);
    const double noise_m = random.normal(plan.range_sigma_m);
    const bool dropped = random.chance(plan.dropout_share);
    // No number is drawn where none is needed: runs without such beams stay as they are.
    const bool lost = plan.no_return_share > 0 && random.chance(plan.no_return_share);
    const double yaw = world_from_laser.yaw + bearing;
    const double range =
        true_range(plan, caster, from, Vector2d(std::cos(yaw), std::sin(yaw)), bodies) + noise_m;
    if (dropped) {
      scan.ranges_m.push_back(0.0F);
    } else if (lost || range >= plan.laser.range_max_m) {
      scan.ranges_m.push_back(nothing);
    } else {
      scan.ranges_m.push_back(range < plan.laser.range_min_m ? 0.0F : static_cast<float>(range));
    }
  }
  return scan;
}

}  // namespace isthmus
