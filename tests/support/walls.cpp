#include "tests/support/walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace isthmus::testing {

double range_to(const Walls& walls, const Eigen::Vector2d& eye, double bearing) {
  const Eigen::Vector2d direction(std::cos(bearing), std::sin(bearing));
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : walls) {
    const Eigen::Vector2d along = to - from;
    const double cross = direction.x() * along.y() - direction.y() * along.x();
    if (std::abs(cross) < 1e-12) continue;
    const Eigen::Vector2d offset = from - eye;
    const double range = (offset.x() * along.y() - offset.y() * along.x()) / cross;
    const double share = (offset.x() * direction.y() - offset.y() * direction.x()) / cross;
    if (range > 0 && share >= 0 && share <= 1) nearest = std::min(nearest, range);
  }
  return nearest;
}

Scan scan_from(const Walls& walls, const Pose& world_from_robot, std::int64_t utime, double range_max_m,
               int beams) {
  Scan scan;
  scan.utime = utime;
  scan.bearing0_rad = -0.5 * std::numbers::pi;
  scan.bearing_step_rad = std::numbers::pi / beams;
  for (int i = 0; i < beams; ++i) {
    const double bearing = world_from_robot.yaw + scan.bearing0_rad + i * scan.bearing_step_rad;
    const double range = range_to(walls, {world_from_robot.x, world_from_robot.y}, bearing);
    scan.ranges_m.push_back(static_cast<float>(range < range_max_m ? range : range_max_m));
  }
  return scan;
}

}  // namespace isthmus::testing
