#include "server/exploration/clear_way.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <utility>

namespace isthmus {
namespace {

struct Reached {
  double along_m = 0;
  SquareId before = -1;
};

/// The squares from the first to one that is wanted; empty: none is reached.
std::vector<SquareId> search(const Roadmap& roadmap, NodeId from, const WayWanted& wanted,
                             std::size_t& opened) {
  using Entry = std::pair<double, SquareId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  std::map<SquareId, Reached> reached;
  const PointGraph& graph = roadmap.graph();
  const SquareId start = roadmap.square(from);
  reached[start] = {};
  waiting.emplace(0.0, start);
  while (!waiting.empty()) {
    const auto [along_m, square] = waiting.top();
    waiting.pop();
    if (along_m > reached.at(square).along_m) continue;
    ++opened;
    if (wanted.is_wanted(square, graph.point_m(square))) {
      std::vector<SquareId> way;
      for (SquareId at = square; at >= 0; at = reached.at(at).before) way.push_back(at);
      std::reverse(way.begin(), way.end());
      return way;
    }
    for (const SquareId next : graph.beside(square)) {
      const double longer = along_m + (graph.point_m(next) - graph.point_m(square)).norm();
      if (longer > wanted.max_m || wanted.is_barred(graph.point_m(next), longer)) continue;
      const auto [found, is_new] = reached.try_emplace(next, Reached{longer, square});
      if (!is_new && !(longer < found->second.along_m)) continue;
      found->second = {longer, square};
      waiting.emplace(longer, next);
    }
  }
  return {};
}

/// Whether a robot may go straight from one cell to another that it sees.
bool is_free(const Roadmap& roadmap, NodeId from, NodeId to, double along_m, const WayWanted& wanted) {
  constexpr double step_m = 0.2;
  if (!roadmap.sees(from, to)) return false;
  const Eigen::Vector2d a = roadmap.ground().centre(from), by = roadmap.ground().centre(to) - a;
  const int steps = static_cast<int>(std::ceil(by.norm() / step_m));
  for (int i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    if (wanted.is_barred(a + share * by, along_m + share * by.norm())) return false;
  }
  return true;
}

}  // namespace

std::vector<NodeId> find_clear_way(const Roadmap& roadmap, NodeId from, const WayWanted& wanted,
                                   std::size_t& opened) {
  std::vector<NodeId> steps;
  for (const SquareId square : search(roadmap, from, wanted, opened)) steps.push_back(roadmap.middle(square));
  if (steps.empty()) return {};
  std::vector<NodeId> way{from};
  double along_m = 0;
  for (std::size_t next = 1; next < steps.size();) {
    while (next + 1 < steps.size() && is_free(roadmap, way.back(), steps[next + 1], along_m, wanted)) ++next;
    along_m += (roadmap.ground().centre(steps[next]) - roadmap.ground().centre(way.back())).norm();
    way.push_back(steps[next++]);
  }
  return way;
}

}  // namespace isthmus
