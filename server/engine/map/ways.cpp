#include "server/engine/map/ways.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace isthmus {

std::vector<double> ways_over_relations_m(const Map& map, std::span<const PatchId> from) {
  const auto at = [](PatchId id) { return static_cast<std::size_t>(id.value); };
  std::vector<double> ways(map.manifold().size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, PatchId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  for (const PatchId id : from) {
    ways[at(id)] = 0;
    waiting.emplace(0, id);
  }
  while (!waiting.empty()) {
    const auto [way, patch] = waiting.top();
    waiting.pop();
    if (way > ways[at(patch)]) continue;
    for (const PatchId next : map.graph().neighbours(patch)) {
      const Pose step = map.relative_pose(patch, next);
      const double there = way + std::hypot(step.x, step.y);
      if (!(there < ways[at(next)])) continue;
      ways[at(next)] = there;
      waiting.emplace(there, next);
    }
  }
  return ways;
}

}  // namespace isthmus
