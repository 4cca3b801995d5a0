#pragma once

#include <optional>

#include "server/output/pictures/map_sheet.hpp"
#include "tools/simulate/live/exploration_run.hpp"

namespace isthmus {

/// The largest island while it is explored: each robot there with its heading, the way that it drives, and
/// where it is to look. None: nothing is on the map.
std::optional<MapSheet> exploration_sheet(const ExplorationView& view);

}  // namespace isthmus
