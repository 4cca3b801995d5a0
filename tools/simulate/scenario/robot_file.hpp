#pragma once

#include <string>
#include <vector>

#include "tools/simulate/scenario/scenario.hpp"
#include "tools/simulate/scenario/scenario_settings.hpp"

namespace isthmus {

/// A robot and where in the file each step of its tour stands, for messages about them.
struct RobotFromFile {
  RobotPlan plan;
  std::vector<std::string> step_where;
};

/// What a scenario says of all robots: its tables `laser`, `odometry`, `camera` and `drive`, and `laps`.
RobotPlan read_common(Fields& scenario);

/// The table of one robot, over what all have in common. It gives start and tour, unless `common` has a tour.
RobotFromFile read_robot(const std::string& name, const Setting& setting, const RobotPlan& common);

}  // namespace isthmus
