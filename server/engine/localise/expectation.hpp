#pragma once

#include <cstdint>

#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// Where a robot is expected at a scan, by its odometry (eq. 11).
struct Expectation {
  Pose local_from_robot;       ///< in the frame of the robot's patch
  Eigen::Matrix3d covariance;  ///< grown from the calibrated covariance
  Eigen::Matrix3d tracking_covariance;
  /// Of the step, in the frame of where it began.
  Eigen::Matrix3d step_covariance = Eigen::Matrix3d::Zero();
  Pose step;              ///< odometry since the last scan, without its bias; none where that is implausible
  Pose claimed_step;      ///< what odometry said
  double seconds = 0;     ///< since the last scan, no less than LocaliseOptions::min_period_s
  bool plausible = true;  ///< false: no robot moves as odometry says
  bool catches_up = false;  ///< what odometry said is taken to hold what it had not told before
  /// The place of the robot, where this begins, was searched for all over the map or told by somebody: what
  /// looks like it elsewhere was weighed then.
  bool sought = false;
  bool seen = false;  ///< the step is the one that two scans show (expect_as_seen), not odometry's

  bool is_known() const { return plausible || seen; }  ///< where the robot went, by odometry or by scans
};

/// What odometry is taken to err by in a turn: nothing that anybody knows, or what it erred by before
/// (TurnError).
enum class TurnErrors : std::uint8_t { at_random, going_on };

/// Whether a motion is so small that it tells only how matching trembles.
bool is_rest(const Pose& step, const OdometryLearningOptions& options);

Expectation expect(const Robot& robot, const Pose& odom_from_robot, std::int64_t utime,
                   const EngineOptions& options, TurnErrors errors = TurnErrors::at_random);

}  // namespace isthmus
