#pragma once

#include <string>

#include "isthmus/goal_t.hpp"
#include "server/engine/record/map_copy.hpp"
#include "server/exploration/expedition.hpp"

namespace isthmus {

/// What a robot is told on <ROBOT>_GOAL, without times. `at`: where it is; all poses on the map.
goal_t goal_message(const MapCopy& map, const std::string& robot, const ManifoldPose& at,
                    const ExplorationOrder& order);

}  // namespace isthmus
