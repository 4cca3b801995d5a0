#include "server/paths/ground/near_patches.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace isthmus {
namespace {

using Ways = std::vector<std::vector<std::pair<PatchId, float>>>;

Ways direct_ways(const MapCopy& map) {
  Ways ways(map.patches.size());
  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    const PatchId a{static_cast<std::int32_t>(i)};
    for (const PatchId b : map.graph.neighbours(a)) {
      const Pose& from = map.poses[i];
      const Pose& to = map.poses[index(b)];
      ways[i].emplace_back(b, static_cast<float>(std::hypot(to.x - from.x, to.y - from.y)));
    }
  }
  return ways;
}

/// Dijkstra's search, cut at the reach. `way` is no_way_m all over, before and after.
std::vector<std::pair<PatchId, float>> ways_from(PatchId start, const Ways& direct, float reach_m,
                                                 std::vector<float>& way) {
  using Entry = std::pair<float, PatchId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<std::pair<PatchId, float>> found;
  way[index(start)] = 0;
  queue.emplace(0.F, start);
  std::vector<PatchId> touched{start};
  while (!queue.empty()) {
    const auto [length, patch] = queue.top();
    queue.pop();
    if (length > way[index(patch)]) continue;
    found.emplace_back(patch, length);
    for (const auto& [next, step] : direct[index(patch)]) {
      if (!(length + step <= reach_m && length + step < way[index(next)])) continue;
      if (way[index(next)] == no_way_m) touched.push_back(next);
      way[index(next)] = length + step;
      queue.emplace(length + step, next);
    }
  }
  for (const PatchId patch : touched) way[index(patch)] = no_way_m;
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

NearPatches::NearPatches(const MapCopy& map, double reach_m) {
  const Ways direct = direct_ways(map);
  std::vector<float> way(map.patches.size(), no_way_m);
  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    const PatchId start{static_cast<std::int32_t>(i)};
    near_.push_back(ways_from(start, direct, static_cast<float>(reach_m), way));
  }
}

float NearPatches::way_m(PatchId a, PatchId b) const {
  if (a == b) return 0;
  if (!a.valid() || index(a) >= near_.size()) return no_way_m;
  const auto& ways = near_[index(a)];
  const auto found = std::lower_bound(ways.begin(), ways.end(), b,
                                      [](const auto& way, PatchId id) { return way.first < id; });
  return found != ways.end() && found->first == b ? found->second : no_way_m;
}

}  // namespace isthmus
