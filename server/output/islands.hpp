#pragma once

#include <vector>

#include "relations/graph.hpp"

namespace isthmus {

/// The islands as output files number them: K = 0 for the one with most patches, ties by id.
struct RankedIslands {
  std::vector<std::vector<PatchId>> patches;  ///< by K; each by id, so the first patch leads
  std::vector<int> rank_of_patch;             ///< K by patch id

  /// K of a patch's island; -1 where there is no such patch.
  int rank(PatchId patch) const {
    const bool known = patch.valid() && static_cast<std::size_t>(patch.value) < rank_of_patch.size();
    return known ? rank_of_patch[static_cast<std::size_t>(patch.value)] : -1;
  }
};

RankedIslands rank_islands(const RelationGraph& graph);

}  // namespace isthmus
