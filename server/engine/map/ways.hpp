#pragma once

#include <span>
#include <vector>

#include "server/engine/map/map.hpp"

namespace isthmus {

/// Metres over relations, by the shortest way, from the nearest of some patches to every patch of the map, by
/// id; infinity where there is none, as on another island.
std::vector<double> ways_over_relations_m(const Map& map, std::span<const PatchId> from);

}  // namespace isthmus
