#pragma once

#include <cstdint>
#include <span>

#include "server/engine/localise/localise.hpp"
#include "server/engine/robot/robot_pose.hpp"

namespace isthmus {

/// Chooses the robot's local map for a scan expected at `local_from_robot`, in the frame of its patch; keeps
/// the one it has while that is near enough.
void choose_local_map(const Map& map, Robot& robot, const Pose& local_from_robot,
                      std::span<const ScanPoint> points, const EngineOptions& options);

/// What a scan tells of the robot's step and of its odometry, its place in the frame of its patch left as it
/// is: how far odometry is right is learned from it.
void move_on(Robot& robot, const Expectation& expectation, const Placement& placement,
             const Pose& odom_from_robot, std::int64_t utime, const EngineOptions& options);

/// Moves the robot's place on to a scan (eqs. 13, 14), after move_on.
void follow(const Map& map, Robot& robot, const Expectation& expectation, const Placement& placement,
            const Pose& odom_from_robot, std::int64_t utime, const EngineOptions& options);

/// The robot's pose, as it is published.
RobotPose answer(const Map& map, const Robot& robot, bool matched);

}  // namespace isthmus
