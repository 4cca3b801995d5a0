#include "server/paths/roads/regions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/paths/ground/no_way.hpp"

namespace isthmus {
namespace {

constexpr std::int32_t block_side_cells = 16;
/// A way over the middles of regions goes out of its way at each end by about so much.
constexpr float detour_m = 0.5;
/// How much longer such a way may be than the shortest of them to be looked at: it is up to 8 % longer than a
/// straight one.
constexpr float longer_share = 1.12F;
constexpr float longer_m = 3;

std::pair<std::int32_t, std::int32_t> block_of(const Cell& cell) {
  return {cell.x & ~(block_side_cells - 1), cell.y & ~(block_side_cells - 1)};
}

}  // namespace

Regions::Regions(const std::vector<Cell>& middles, const PointGraph& squares) : region_(squares.size(), -1) {
  std::vector<Eigen::Vector2d> points_m;
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  for (std::size_t first = 0; first < region_.size(); ++first) {
    if (region_[first] >= 0) continue;
    const auto region = static_cast<std::int32_t>(points_m.size());
    std::vector<std::int32_t> members{static_cast<std::int32_t>(first)};
    region_[first] = region;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < members.size(); ++i) {
      sum += squares.point_m(members[i]);
      for (const std::int32_t next : squares.beside(members[i])) {
        const auto at = static_cast<std::size_t>(next);
        if (region_[at] >= 0 || block_of(middles[at]) != block_of(middles[first])) continue;
        region_[at] = region;
        members.push_back(next);
      }
    }
    points_m.emplace_back(sum / static_cast<double>(members.size()));
  }
  for (std::size_t square = 0; square < region_.size(); ++square)
    for (const std::int32_t next : squares.beside(static_cast<std::int32_t>(square)))
      if (of(next) != region_[square]) pairs.emplace_back(region_[square], of(next));
  graph_ = PointGraph(std::move(points_m), pairs);
}

std::vector<float> Regions::left_m(std::int32_t from_square, std::int32_t to_square) const {
  const std::int32_t from = of(from_square), to = of(to_square);
  SearchReach reach{from, longer_share, longer_m};
  std::vector<float> left = graph_.lengths_from(to, reach);
  const float shortest = left[static_cast<std::size_t>(from)];
  if (!std::isfinite(shortest)) return {};
  reach.goal = to;
  const std::vector<float> there = graph_.lengths_from(from, reach);
  const float longest = longer_share * shortest + longer_m;
  for (std::size_t region = 0; region < left.size(); ++region) {
    const bool worth = there[region] + left[region] <= longest;
    left[region] = worth ? std::max(0.F, left[region] - detour_m) : no_way_m;
  }
  return left;
}

}  // namespace isthmus
