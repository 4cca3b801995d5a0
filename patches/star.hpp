#pragma once

#include <vector>

#include "patches/scan.hpp"

namespace isthmus {

/// A scan's free space as ranges over bearing around the laser: answers "is this point free?" in constant
/// time. The polysolid of the same scan is the exact form, used where a patch is made and in exports.
class Star {
 public:
  Star() = default;
  /// Beams are cut at max_range_m; a beam without return counts as free up to no_return_range_m.
  Star(const Scan& scan, const Laser& laser, double max_range_m, double no_return_range_m);

  /// Whether a point of the robot's frame lies in the free space seen.
  bool contains(const Eigen::Vector2d& point_robot) const { return depth_m(point_robot) > 0; }

  /// How far the point lies in front of the obstacle seen along its bearing, in metres; negative behind it,
  /// -infinity outside the field of view or where that beam says nothing.
  double depth_m(const Eigen::Vector2d& point_robot) const;

  const Pose& robot_from_laser() const { return robot_from_laser_; }
  double bearing0_rad() const { return bearing0_rad_; }
  double bearing_step_rad() const { return bearing_step_rad_; }  ///< positive
  /// Free range of each beam in metres (0: nothing known), by rising bearing.
  const std::vector<float>& ranges_m() const { return ranges_m_; }
  /// The farthest free range.
  double reach_m() const { return reach_m_; }

 private:
  Pose robot_from_laser_;
  Pose laser_from_robot_;
  double bearing0_rad_ = 0;
  double bearing_step_rad_ = 0;
  double reach_m_ = 0;
  std::vector<float> ranges_m_;
};

}  // namespace isthmus
