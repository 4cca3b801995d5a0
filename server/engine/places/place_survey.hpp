#pragma once

#include <span>
#include <vector>

#include "server/engine/places/place_candidates.hpp"
#include "server/engine/places/place_search.hpp"

namespace isthmus {

/// Leaves out places of other islands at which a search would find no answer for the piece that they are for,
/// as good as `min_score`: by a grid of each such island as a whole (scanmatch/fit_survey.hpp), at a small
/// part of what searching costs. On its own island the map says where to look: few of those places could be
/// left out. Of an island that is too wide for a grid all are left in.
void leave_possible(std::vector<std::vector<PlaceCandidate>>& places_by_piece,
                    std::span<const RigidPiece> pieces, const Map& map, double min_score,
                    const EngineOptions& options);

}  // namespace isthmus
