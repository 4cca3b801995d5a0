#pragma once

#include <Eigen/Core>
#include <vector>

namespace isthmus {

/// A straight piece of a way, parallel to an axis.
struct FloorLeg {
  Eigen::Vector2d from, to;
  double lane_m = 0;  ///< how far to the right of the leg the robot drives

  Eigen::Vector2d direction() const { return (to - from).normalized(); }
  Eigen::Vector2d offset() const { return lane_m * Eigen::Vector2d(direction().y(), -direction().x()); }
};

/// Where a robot goes from leg to leg, of which there is at least one; where it begins is left out.
std::vector<Eigen::Vector2d> waypoints_of(const std::vector<FloorLeg>& legs);

}  // namespace isthmus
