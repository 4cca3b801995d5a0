#include "tools/simulate/live/seen_ground.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {

void SeenGround::add(const Pose& world_from_robot, const Scan& scan, const Laser& laser) {
  const Pose laser_from_world = inverse(world_from_robot * laser.robot_from_laser);
  const auto beams = static_cast<double>(scan.ranges_m.size());
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (seen_[i]) continue;
    const Eigen::Vector2d point = laser_from_world * ground_.points()[i];
    const double range = point.norm();
    if (range > laser.range_max_m) continue;
    const double bearing = std::atan2(point.y(), point.x());
    const double beam = std::round((bearing - scan.bearing0_rad) / scan.bearing_step_rad);
    if (!(beam >= 0 && beam < beams)) continue;
    seen_[i] = static_cast<double>(scan.ranges_m[static_cast<std::size_t>(beam)]) >= range;
  }
}

double SeenGround::share() const {
  return static_cast<double>(std::ranges::count(seen_, 1)) / std::max(1.0, static_cast<double>(seen_.size()));
}

}  // namespace isthmus
