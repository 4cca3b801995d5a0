#include "server/paths/roads/point_graph.hpp"

#include <algorithm>
#include <functional>
#include <queue>

#include "server/paths/ground/no_way.hpp"

namespace isthmus {

PointGraph::PointGraph(std::vector<Eigen::Vector2d> points_m,
                       std::vector<std::pair<std::int32_t, std::int32_t>> pairs)
    : points_m_(std::move(points_m)) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  beside_.reserve(pairs.size());
  for (const auto& [from, to] : pairs) {
    first_.resize(at(from) + 1, static_cast<std::uint32_t>(beside_.size()));
    beside_.push_back(to);
  }
  first_.resize(points_m_.size() + 1, static_cast<std::uint32_t>(beside_.size()));
}

std::vector<float> PointGraph::lengths_from(std::int32_t start, const SearchReach& reach) const {
  using Entry = std::pair<float, std::int32_t>;
  std::vector<float> length(size(), no_way_m);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  length[at(start)] = 0;
  waiting.emplace(0.F, start);
  float farthest = no_way_m;
  while (!waiting.empty() && waiting.top().first <= farthest) {
    const auto [way, number] = waiting.top();
    waiting.pop();
    if (way > length[at(number)]) continue;
    if (number == reach.goal) farthest = reach.share * way + reach.more_m;
    for (const std::int32_t next : beside(number)) {
      const float longer = way + static_cast<float>((point_m(next) - point_m(number)).norm());
      if (!(longer < length[at(next)])) continue;
      length[at(next)] = longer;
      waiting.emplace(longer, next);
    }
  }
  return length;
}

}  // namespace isthmus
