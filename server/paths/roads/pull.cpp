#include "server/paths/roads/pull.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace isthmus {
namespace {

constexpr int rounds = 10;
constexpr double worth_a_round = 0.001;                                   // of the length
constexpr double shares[] = {1, 0.7, 0.5, 0.35, 0.25, 0.18, 0.12, 0.06};  // of the legs at a corner

std::vector<NodeId> leave_out_what_is_seen_past(const Roadmap& roadmap, const std::vector<NodeId>& way) {
  std::vector<NodeId> left{way.front()};
  for (std::size_t next = 1; next < way.size();) {
    while (next + 1 < way.size() && roadmap.sees(left.back(), way[next + 1])) ++next;
    left.push_back(way[next++]);
  }
  return left;
}

/// The cell a share of the way along, if the footprint fits from `from` to there.
std::optional<NodeId> along(const Roadmap& roadmap, NodeId from, NodeId to, double share) {
  const Cell a = roadmap.ground().cell(from), b = roadmap.ground().cell(to);
  const Cell at{a.x + static_cast<std::int32_t>(std::lround(share * (b.x - a.x))),
                a.y + static_cast<std::int32_t>(std::lround(share * (b.y - a.y)))};
  return roadmap.straight(from, at);
}

/// Cells along the leg before or after a corner, each seen from the one end of the rest and from the corner.
std::vector<NodeId> cells_along(const Roadmap& roadmap, NodeId corner, NodeId end, bool is_before) {
  std::vector<NodeId> cells;
  for (const double share : shares) {
    const auto cell = along(roadmap, corner, end, share);
    if (!cell || *cell == corner) continue;
    if (is_before ? roadmap.sees(end, *cell) : roadmap.sees(*cell, end)) cells.push_back(*cell);
  }
  return cells;
}

struct Cut {
  double length_m = 0;
  NodeId a = -1, b = -1;
};

/// Two cells on the legs of a corner, of which one sees the other, over which the way is shortest. What it
/// bends around may lie at one of the legs alone: they are not so far out on both.
std::optional<Cut> cut(const Roadmap& roadmap, NodeId before, NodeId corner, NodeId after) {
  const Ground& ground = roadmap.ground();
  const double least_m = length_m(ground, {before, corner, after});
  std::vector<Cut> cuts;
  const std::vector<NodeId> ends = cells_along(roadmap, corner, after, false);
  for (const NodeId a : cells_along(roadmap, corner, before, true))
    for (const NodeId b : ends)
      if (const double length = length_m(ground, {before, a, b, after}); length < least_m)
        cuts.push_back({length, a, b});
  std::stable_sort(cuts.begin(), cuts.end(),
                   [](const Cut& one, const Cut& other) { return one.length_m < other.length_m; });
  const auto found =
      std::find_if(cuts.begin(), cuts.end(), [&](const Cut& one) { return roadmap.sees(one.a, one.b); });
  return found == cuts.end() ? std::nullopt : std::optional(*found);
}

std::vector<NodeId> cut_corners(const Roadmap& roadmap, const std::vector<NodeId>& way) {
  std::vector<NodeId> cut_way{way.front()};
  for (std::size_t i = 1; i + 1 < way.size(); ++i) {
    if (const auto ends = cut(roadmap, cut_way.back(), way[i], way[i + 1])) {
      cut_way.push_back(ends->a);
      cut_way.push_back(ends->b);
    } else {
      cut_way.push_back(way[i]);
    }
  }
  cut_way.push_back(way.back());
  return cut_way;
}

}  // namespace

std::vector<NodeId> pull(const Roadmap& roadmap, std::vector<NodeId> way) {
  way = leave_out_what_is_seen_past(roadmap, way);
  double length = length_m(roadmap.ground(), way);
  for (int round = 0; round < rounds && way.size() > 2; ++round) {
    std::vector<NodeId> next = leave_out_what_is_seen_past(roadmap, cut_corners(roadmap, way));
    const double shorter = length_m(roadmap.ground(), next);
    if (shorter > (1 - worth_a_round) * length) break;
    way = std::move(next);
    length = shorter;
  }
  return way;
}

double length_m(const Ground& ground, const std::vector<NodeId>& way) {
  double length = 0;
  for (std::size_t i = 1; i < way.size(); ++i)
    length += (ground.centre(way[i]) - ground.centre(way[i - 1])).norm();
  return length;
}

}  // namespace isthmus
