#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// Where a robot's body may be, in the frame of another.
struct Body {
  Eigen::Vector2d position;
  double radius_m = 0;
};

/// Notes that a robot has just seen another: what its beams hit there is no wall. `odom_from_robot` at the
/// sighting.
void note_teammate(Robot& robot, const SightingEvent& sighting, const std::string& target,
                   const Pose& odom_from_robot);

/// The bodies of the robots just seen, and of those that the map predicts, around a robot whose odometry at a
/// stamp is given.
std::vector<Body> teammates_around(const Map& map, const std::map<std::string, Robot>& robots,
                                   const Robot& robot, const Pose& odom_from_robot, std::int64_t utime,
                                   const TeammateOptions& options);

/// The scan without the beams that end on a body.
Scan without_bodies(const Scan& scan, const Laser& laser, const std::vector<Body>& bodies);

}  // namespace isthmus
