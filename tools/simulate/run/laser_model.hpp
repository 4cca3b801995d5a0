#pragma once

#include <vector>

#include "tools/simulate/plan/random.hpp"
#include "tools/simulate/run/ray_caster.hpp"
#include "tools/simulate/scenario/scenario.hpp"

namespace isthmus {

/// Another robot, as a laser sees it.
struct Passerby {
  Eigen::Vector2d centre;
  double radius_m = 0;
};

/// The mount and limits that the robot tells of: those of the plan, and the error of its survey.
Laser declared_laser(const LaserPlan& plan);

/// One scan taken at a pose, with noise, dropouts and no-returns, all of its beams turned by `shift_rad`;
/// utime is left to the caller.
Scan take_scan(const LaserPlan& plan, const RayCaster& caster, const Pose& world_from_robot,
               const std::vector<Passerby>& bodies, Random& random, double shift_rad = 0);

}  // namespace isthmus
