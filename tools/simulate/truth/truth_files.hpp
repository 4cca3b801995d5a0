#pragma once

#include <string>
#include <vector>

#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// The true pose of robot2's base at utime2 in the frame of robot1's base at utime1.
struct ScanRelation {
  std::string robot1;
  std::int64_t utime1 = 0;
  std::string robot2;
  std::int64_t utime2 = 0;
  Pose pose;
};

/// Pairs of scans to judge a map by: of each robot, neighbouring ones along its way and ones at least 30 s
/// apart; of two robots, ones near in space. None spans a time in which the robot was carried.
std::vector<ScanRelation> sample_relations(const std::vector<RobotTruth>& truth, std::uint64_t seed);

/// Writes ROBOT.tum, relations.csv, outliers.csv, floor_plan.csv (walls) and floor_plan.png into a directory,
/// made where missing; each file is complete or absent. Throws std::runtime_error naming the file and the
/// reason.
void write_truth(const Scenario& scenario, const SimulatedRun& run,
                 const std::vector<ScanRelation>& relations, const std::string& directory);

}  // namespace isthmus
