#pragma once

#include <vector>

#include "tools/simulate/plan/floor_plan.hpp"
#include "tools/simulate/scenario/robot_file.hpp"

namespace isthmus {

/// A building made from a seed, and robots that drive in it.
struct FloorFromFile {
  Building building;
  std::vector<RobotFromFile> robots;
};

/// Makes the floor that a scenario's table `floor` asks for. `robots`: the scenario's table of that name or
/// nullptr, laid over the robots made, which are called R1, R2 and so on.
FloorFromFile make_floor(const Setting& floor, const Setting* robots, const RobotPlan& common);

}  // namespace isthmus
