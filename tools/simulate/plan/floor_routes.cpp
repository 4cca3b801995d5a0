#include "tools/simulate/plan/floor_routes.hpp"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

namespace isthmus {
namespace {

using Eigen::Vector2d;

// Where a point lies before the middle line of a corridor.
Vector2d onto_middle(const FloorCell& corridor, const Vector2d& point) {
  const Vector2d middle = corridor.middle();
  return corridor.along_x ? Vector2d(point.x(), middle.y()) : Vector2d(middle.x(), point.y());
}

// Wide enough apart that robots pass one another, and never near a wall.
double lane_of(const FloorCell& corridor) {
  const double width = corridor.along_x ? corridor.size().y() : corridor.size().x();
  return std::max(0.34, 0.18 * width);
}

}  // namespace

FloorRoutes::FloorRoutes(const FloorLayout& layout) : nodes_of_corridor_(layout.cells.size()) {
  for (const FloorBorder& border : layout.borders) {
    const FloorCell &a = layout.cells[border.a], &b = layout.cells[border.b];
    if (!a.corridor || !b.corridor || a.along_x == b.along_x) continue;
    const Vector2d crossing = onto_middle(b, onto_middle(a, b.middle()));
    crossings_.push_back(add_node(crossing, {border.a, border.b}));
  }
  for (const FloorDoor& door : layout.doors) {
    const FloorBorder& border = layout.borders[door.border];
    const bool from_a = layout.cells[border.a].corridor;
    const std::size_t corridor = from_a ? border.a : border.b, room = from_a ? border.b : border.a;
    const FloorCell& way = layout.cells[corridor];
    // A door in a corridor's end has no lane that passes it.
    if (!way.corridor || way.along_x == border.upright) continue;
    const Vector2d middle = border.point(door.along);
    const Vector2d before = onto_middle(way, middle);
    stops_.push_back({room, add_node(before, {corridor}), middle, (middle - before).normalized()});
  }
  link_along(layout);
}

std::size_t FloorRoutes::add_node(const Vector2d& position, const std::vector<std::size_t>& corridors) {
  for (const std::size_t corridor : corridors) nodes_of_corridor_[corridor].push_back(nodes_.size());
  nodes_.push_back({position, {}});
  return nodes_.size() - 1;
}

void FloorRoutes::link_along(const FloorLayout& layout) {
  for (std::size_t corridor = 0; corridor < nodes_of_corridor_.size(); ++corridor) {
    std::vector<std::size_t>& nodes = nodes_of_corridor_[corridor];
    const int along = layout.cells[corridor].along_x ? 0 : 1;
    std::ranges::stable_sort(nodes, {}, [&](std::size_t node) { return nodes_[node].position[along]; });
    const double lane_m = lane_of(layout.cells[corridor]);
    for (std::size_t i = 1; i < nodes.size(); ++i) {
      const std::size_t a = nodes[i - 1], b = nodes[i];
      const double length_m = (nodes_[b].position - nodes_[a].position).norm();
      nodes_[a].links.push_back({b, length_m, lane_m});
      nodes_[b].links.push_back({a, length_m, lane_m});
    }
  }
}

double FloorRoutes::lane_m(std::size_t from, std::size_t to) const {
  for (const Link& link : nodes_[from].links) {
    if (link.to == to) return link.lane_m;
  }
  return 0;
}

FloorRoutes::Ways FloorRoutes::ways_from(std::size_t node) const {
  Ways ways{std::vector<double>(nodes_.size(), std::numeric_limits<double>::infinity()),
            std::vector<std::size_t>(nodes_.size(), node)};
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> ahead;
  ways.distance_m[node] = 0;
  ahead.emplace(0, node);
  while (!ahead.empty()) {
    const auto [distance, at] = ahead.top();
    ahead.pop();
    if (distance > ways.distance_m[at]) continue;
    for (const Link& link : nodes_[at].links) {
      if (distance + link.length_m >= ways.distance_m[link.to]) continue;
      ways.distance_m[link.to] = distance + link.length_m;
      ways.before[link.to] = at;
      ahead.emplace(ways.distance_m[link.to], link.to);
    }
  }
  return ways;
}

std::vector<std::size_t> FloorRoutes::way_to(const Ways& ways, std::size_t node) {
  std::vector<std::size_t> way{node};
  while (ways.distance_m[way.back()] > 0 && ways.before[way.back()] != way.back())
    way.push_back(ways.before[way.back()]);
  std::ranges::reverse(way);
  return way;
}

}  // namespace isthmus
