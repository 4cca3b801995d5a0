#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/engine/input/event.hpp"
#include "tools/simulate/run/sighting_model.hpp"
#include "tools/simulate/scenario/scenario.hpp"

namespace isthmus {

/// Where a robot's base was when a scan was taken, utime the scan's stamp; or where it was at utime.
struct TruePose {
  std::int64_t utime = 0;
  std::size_t stretch = 0;  ///< rises when the robot is carried
  Pose world_from_robot;
};

struct RobotTruth {
  std::string robot;
  std::vector<TruePose> poses;  ///< one for each scan, in order; without a laser, at 10 Hz
};

struct FalseSighting {
  std::size_t row = 0;  ///< among all sightings of the run, in event order, from 1
  SightingEvent reported;
  std::string kind;    ///< "wrong_id", "gross", "phantom"
  TrueSighting truth;  ///< barcode -1 for a phantom
};

struct SimulatedRun {
  std::vector<Event> events;  ///< in order of time; within a robot, odometry comes before its scan
  std::vector<RobotTruth> truth;
  std::vector<FalseSighting> false_sightings;
};

/// Runs a scenario: the same for the same scenario and seed, always. Throws std::runtime_error where a robot
/// cannot drive its tour or runs into a wall.
SimulatedRun simulate(const Scenario& scenario, std::uint64_t seed);

}  // namespace isthmus
