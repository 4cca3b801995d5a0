#pragma once

#include <Eigen/Core>
#include <span>

#include "tools/simulate/scenario/scenario.hpp"

namespace isthmus {

struct Motion {
  double speed_mps = 0;
  double turn_rate_rps = 0;
};

/// The motion by which a robot comes nearer to a target and touches nothing for the next second and a half:
/// of a few speeds and turn rates the best, each tried ahead (Fox, Burgard and Thrun 1997, the dynamic
/// window). Target and obstacles in the robot's frame, metres; none of them is nearer than `margin_m` to its
/// outline on the way. It stands, or turns on the spot, where nothing else is free.
Motion steer(const DrivePlan& drive, double radius_m, const Eigen::Vector2d& target,
             std::span<const Eigen::Vector2d> obstacles, double margin_m);

}  // namespace isthmus
