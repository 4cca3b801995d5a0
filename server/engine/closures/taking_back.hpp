#pragma once

#include <vector>

#include "server/engine/closures/closure_ledger.hpp"
#include "server/engine/sightings/tag_placer.hpp"

namespace isthmus {

/// Takes an accepted closure out of the map, with all that depends on it (withdrawal.hpp), and brings in line
/// what is kept beside the map: tags that too little is left of are nowhere again, past places are given on
/// patches of the robot's own island, sightings wait in the pool again, closures that have fallen with it may
/// come again. Its own state and sightings stay as they are. Returns a patch of each island that has changed.
std::vector<PatchId> take_back(World world, ClosureId id, ClosureLedger& ledger,
                               MutualObservations& observations, TagPlacer& tags);

}  // namespace isthmus
