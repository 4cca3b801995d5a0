#include "server/output/tables/islands.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace isthmus {
namespace {

// What `counts` says no to makes no island of its own.
RankedIslands ranked(const RelationGraph& graph, const std::function<bool(PatchId)>& is_tag,
                     const std::function<bool(PatchId)>& counts) {
  struct Island {
    std::vector<PatchId> patches;
    std::vector<PatchId> tags;
  };
  std::vector<Island> islands;
  for (const std::vector<PatchId>& all : graph.islands()) {
    Island island;
    for (const PatchId id : all) (is_tag(id) ? island.tags : island.patches).push_back(id);
    if (std::ranges::any_of(island.patches, counts)) islands.push_back(std::move(island));
  }
  // Islands come in order of their ids; a stable sort keeps that among equals.
  std::stable_sort(islands.begin(), islands.end(),
                   [](const Island& a, const Island& b) { return a.patches.size() > b.patches.size(); });

  RankedIslands ranked;
  ranked.rank_of_patch.assign(graph.patch_count(), -1);
  for (Island& island : islands) {
    const auto k = static_cast<int>(ranked.patches.size());
    for (const PatchId id : island.patches) ranked.rank_of_patch[static_cast<std::size_t>(id.value)] = k;
    for (const PatchId id : island.tags) ranked.rank_of_patch[static_cast<std::size_t>(id.value)] = k;
    ranked.patches.push_back(std::move(island.patches));
    ranked.tags.push_back(std::move(island.tags));
  }
  return ranked;
}

bool is_tag(const PatchPtr& patch) { return patch->tag >= 0; }

}  // namespace

RankedIslands rank_islands(const MapCopy& map) {
  return ranked(
      map.graph, [&](PatchId id) { return is_tag(map.patches[static_cast<std::size_t>(id.value)]); },
      [&](PatchId id) { return !std::ranges::binary_search(map.left_out, id); });
}

std::size_t patch_count(const MapCopy& map) {
  return map.patches.size() -
         static_cast<std::size_t>(std::count_if(map.patches.begin(), map.patches.end(), is_tag)) -
         map.left_out.size();
}

}  // namespace isthmus
