#pragma once

#include <cstdint>
#include <string>

#include "patches/manifold.hpp"

namespace isthmus {

/// Where a robot is after a scan.
struct RobotPose {
  std::string robot;
  std::int64_t utime = 0;  ///< of the scan it answers
  IslandId island;
  ManifoldPose pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of patch_from_robot, relative to the patch
  Pose map_from_robot;                                   ///< projected on the island's plane
  Pose map_from_odom;
  bool matched = false;  ///< false: predicted from odometry
};

}  // namespace isthmus
