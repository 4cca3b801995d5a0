#include "server/output/islands.hpp"

#include <algorithm>

namespace isthmus {

RankedIslands rank_islands(const RelationGraph& graph) {
  RankedIslands ranked;
  ranked.patches = graph.islands();
  // Islands come in order of their ids; a stable sort keeps that among equals.
  std::stable_sort(ranked.patches.begin(), ranked.patches.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  ranked.rank_of_patch.assign(graph.patch_count(), -1);
  for (std::size_t k = 0; k < ranked.patches.size(); ++k) {
    for (const PatchId patch : ranked.patches[k]) {
      ranked.rank_of_patch[static_cast<std::size_t>(patch.value)] = static_cast<int>(k);
    }
  }
  return ranked;
}

}  // namespace isthmus
