#pragma once

#include "server/engine/localise/expectation.hpp"
#include "tests/support/walls.hpp"

namespace isthmus::testing {

/// A robot at r on patch 0, with its odometry at time 0.
inline Robot robot_at(const Pose& patch_from_robot, const Pose& odom_from_robot = {}) {
  Robot robot;
  robot.place = Localisation{};
  robot.place->pose = {PatchId{0}, patch_from_robot};
  robot.place->odom_from_robot = odom_from_robot;
  robot.place->last_patch = PatchId{0};
  return robot;
}

/// What a robot at `truth` among `walls` is matched with: one patch, whose frame is `local`.
inline LocalMap local_map_of(const Walls& walls, const Pose& local_from_patch = {}) {
  return {PatchId{0}, {{patch_from(walls, PatchId{0}, local_from_patch), local_from_patch}}};
}

inline Expectation expecting(const Pose& local_from_robot, double sigma_m = 0.1, double sigma_rad = 0.05) {
  Expectation expectation;
  expectation.local_from_robot = local_from_robot;
  expectation.tracking_covariance =
      Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
  expectation.covariance = 4 * expectation.tracking_covariance;
  return expectation;
}

}  // namespace isthmus::testing
