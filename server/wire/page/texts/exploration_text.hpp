#pragma once

#include <string>

#include "server/wire/goals/team_goals.hpp"
#include "server/wire/page/map/shown_map.hpp"

namespace isthmus {

/// Who explores what, as a line of JSON, where the map has it now: `goals` (robot, reason, island, `goal`
/// [x, y, yaw] or null, `gain` m², `way` [x, y]) and `frontiers` ([island, x, y, yaw, gain]), each where it
/// is seen from.
std::string exploration_text(const TeamGoals& team, const ShownMap& shown);

}  // namespace isthmus
