#pragma once

#include <string>

#include "tools/simulate/live/live_team.hpp"
#include "tools/simulate/live/seen_ground.hpp"

namespace isthmus {

/// Writes DIRECTORY/drive-SECONDS.png: the building's walls, what lasers have seen of the ground that robots
/// can come to, their true ways, and where they are. Throws std::runtime_error where it cannot.
void draw_drive(const FloorPlan& plan, const LiveTeam& team, const ReachableGround& ground,
                const SeenGround& seen, const std::string& directory);

}  // namespace isthmus
