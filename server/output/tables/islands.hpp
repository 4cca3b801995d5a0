#pragma once

#include <cstddef>
#include <vector>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// The islands as output files number them: K = 0 for the one with most patches, ties by id. Fixed tags are
/// points and no patches here: they count for nothing, and an island of nothing else has no K; nor has one of
/// patches that operators have left out.
struct RankedIslands {
  std::vector<std::vector<PatchId>> patches;  ///< by K; each by id, so the first patch leads
  std::vector<std::vector<PatchId>> tags;     ///< by K; each by id
  std::vector<int> rank_of_patch;             ///< K by patch id, tags too; -1 where there is none

  /// K of a patch's island; -1 where there is no such patch.
  int rank(PatchId patch) const {
    const bool known = patch.valid() && static_cast<std::size_t>(patch.value) < rank_of_patch.size();
    return known ? rank_of_patch[static_cast<std::size_t>(patch.value)] : -1;
  }
};

RankedIslands rank_islands(const MapCopy& map);

/// How many of the map's patches are neither fixed tags nor left out.
std::size_t patch_count(const MapCopy& map);

}  // namespace isthmus
