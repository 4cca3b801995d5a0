#include "server/engine/map/ways.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace isthmus {
namespace {

std::size_t at(PatchId id) { return static_cast<std::size_t>(id.value); }

// Dijkstra 1959. `for_each_step(patch, take)` calls take(next, length_m) for those next to a patch.
template <typename ForEachStep>
std::vector<double> shortest_ways_m(std::size_t patches, std::span<const PatchId> from,
                                    const ForEachStep& for_each_step) {
  std::vector<double> ways(patches, std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, PatchId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  for (const PatchId id : from) {
    ways[at(id)] = 0;
    waiting.emplace(0, id);
  }
  while (!waiting.empty()) {
    const double way = waiting.top().first;
    const PatchId patch = waiting.top().second;
    waiting.pop();
    if (way > ways[at(patch)]) continue;
    for_each_step(patch, [&](PatchId next, double length_m) {
      const double there = way + length_m;
      if (!(there < ways[at(next)])) return;
      ways[at(next)] = there;
      waiting.emplace(there, next);
    });
  }
  return ways;
}

template <typename Take>
void for_each_relation(const Map& map, PatchId patch, const Take& take) {
  const Pose& here = map.manifold().pose(patch);
  for (const PatchId next : map.graph().neighbours(patch)) {
    const Pose& there = map.manifold().pose(next);
    take(next, std::hypot(there.x - here.x, there.y - here.y));
  }
}

}  // namespace

WayNetwork::WayNetwork(const Map& map) {
  const std::size_t patches = map.manifold().size();
  first_.reserve(patches + 1);
  steps_.reserve(2 * map.graph().relations().size());
  for (std::size_t i = 0; i < patches; ++i) {
    first_.push_back(steps_.size());
    for_each_relation(map, PatchId{static_cast<std::int32_t>(i)}, [&](PatchId next, double length_m) {
      steps_.push_back({next, length_m});
    });
  }
  first_.push_back(steps_.size());
}

std::vector<double> WayNetwork::ways_m(std::span<const PatchId> from) const {
  return shortest_ways_m(first_.size() - 1, from, [&](PatchId patch, const auto& take) {
    for (std::size_t i = first_[at(patch)]; i < first_[at(patch) + 1]; ++i)
      take(steps_[i].to, steps_[i].length_m);
  });
}

std::vector<double> ways_over_relations_m(const Map& map, std::span<const PatchId> from) {
  return shortest_ways_m(map.manifold().size(), from,
                         [&](PatchId patch, const auto& take) { for_each_relation(map, patch, take); });
}

}  // namespace isthmus
