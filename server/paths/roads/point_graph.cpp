#include "server/paths/roads/point_graph.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>

#include "server/paths/ground/no_way.hpp"

namespace isthmus {

PointGraph::PointGraph(std::vector<Eigen::Vector2d> points_m,
                       const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs)
    : points_m_(std::move(points_m)) {
  // By where they begin first: few are left to sort at once then.
  std::vector<std::uint32_t> begins(points_m_.size() + 1);
  for (const auto& [from, to] : pairs) ++begins[at(from) + 1];
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  std::vector<std::int32_t> ends(pairs.size());
  std::vector<std::uint32_t> next(begins.begin(), begins.end() - 1);
  for (const auto& [from, to] : pairs) ends[next[at(from)]++] = to;
  first_.reserve(begins.size());
  for (std::size_t from = 0; from < points_m_.size(); ++from) {
    const auto low = ends.begin() + begins[from], high = ends.begin() + begins[from + 1];
    std::sort(low, high);
    beside_.insert(beside_.end(), low, std::unique(low, high));
    first_.push_back(static_cast<std::uint32_t>(beside_.size()));
  }
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
