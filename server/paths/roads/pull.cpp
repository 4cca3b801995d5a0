#include "server/paths/roads/pull.hpp"

#include <cmath>
#include <optional>
#include <utility>

namespace isthmus {
namespace {

constexpr int rounds = 10;
constexpr double worth_a_round = 0.001;  // of the length
constexpr double shares[] = {1,    0.7,  0.5,  0.35,
                             0.25, 0.18, 0.12, 0.06};  // of the legs at a corner, tried in turn

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

/// Two cells on the legs of a corner, as far out as possible, of which one sees the other.
std::optional<std::pair<NodeId, NodeId>> cut(const Roadmap& roadmap, NodeId before, NodeId corner,
                                             NodeId after) {
  for (const double share : shares) {
    const auto a = along(roadmap, corner, before, share), b = along(roadmap, corner, after, share);
    if (!a || !b || *a == corner || *b == corner) continue;
    const bool shorter = length_m(roadmap.ground(), {before, *a, *b, after}) <
                         length_m(roadmap.ground(), {before, corner, after});
    if (shorter && roadmap.sees(before, *a) && roadmap.sees(*a, *b) && roadmap.sees(*b, after))
      return {{*a, *b}};
  }
  return std::nullopt;
}

std::vector<NodeId> cut_corners(const Roadmap& roadmap, const std::vector<NodeId>& way) {
  std::vector<NodeId> cut_way{way.front()};
  for (std::size_t i = 1; i + 1 < way.size(); ++i) {
    if (const auto ends = cut(roadmap, cut_way.back(), way[i], way[i + 1])) {
      cut_way.push_back(ends->first);
      cut_way.push_back(ends->second);
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
