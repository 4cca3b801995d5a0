#include "patches/star.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace isthmus {

Star::Star(const Scan& scan, const Laser& laser, double max_range_m, double no_return_range_m)
    : robot_from_laser_(laser.robot_from_laser),
      laser_from_robot_(inverse(laser.robot_from_laser)),
      bearing0_rad_(scan.bearing0_rad),
      bearing_step_rad_(std::abs(scan.bearing_step_rad)) {
  ranges_m_.reserve(scan.ranges_m.size());
  for (const float range_m : scan.ranges_m) {
    double free_m = 0;
    switch (classify(range_m, laser)) {
      case BeamKind::hit:
        free_m = std::min<double>(range_m, max_range_m);
        break;
      case BeamKind::no_return:
        free_m = std::min(no_return_range_m, max_range_m);
        break;
      case BeamKind::ignored:
        break;
    }
    ranges_m_.push_back(static_cast<float>(free_m));
    reach_m_ = std::max(reach_m_, free_m);
  }
  if (scan.bearing_step_rad < 0 && !ranges_m_.empty()) {
    std::reverse(ranges_m_.begin(), ranges_m_.end());
    bearing0_rad_ += static_cast<double>(ranges_m_.size() - 1) * scan.bearing_step_rad;
  }
}

double Star::depth_m(const Eigen::Vector2d& point_robot) const {
  constexpr double nothing = -std::numeric_limits<double>::infinity();
  if (ranges_m_.empty() || !(bearing_step_rad_ > 0)) return nothing;
  const Eigen::Vector2d point = laser_from_robot_ * point_robot;
  const double distance = point.norm();
  if (!(distance <= reach_m_)) return nothing;
  double bearing = std::atan2(point.y(), point.x()) - bearing0_rad_;
  bearing -= 2 * std::numbers::pi * std::floor(bearing / (2 * std::numbers::pi));  // [0, 2 pi)
  if (bearing > 2 * std::numbers::pi - 0.5 * bearing_step_rad_) bearing = 0;  // just below the first beam
  const double nearest = bearing / bearing_step_rad_ + 0.5;
  if (!(nearest >= 0 && nearest < static_cast<double>(ranges_m_.size()))) return nothing;
  const auto beam = static_cast<std::size_t>(nearest);
  if (!(ranges_m_[beam] > 0)) return nothing;
  return ranges_m_[beam] - distance;
}

}  // namespace isthmus
