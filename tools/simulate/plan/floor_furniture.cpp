#include "tools/simulate/plan/floor_furniture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/simulate/plan/clutter.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr double from_ways_m = 0.45;
constexpr double from_corridor_ways_m = 0.33;
constexpr double from_doors_m = 0.9;
constexpr double from_furniture_m = 0.02;
constexpr double half_wall_m = 0.06;
constexpr double hall_m2 = 35;

// What a new piece in one cell must stay away from.
struct Surroundings {
  std::vector<Segment> ways;
  std::vector<Vector2d> doors;
  std::vector<std::vector<Vector2d>> furniture;
};

Segment side(const std::vector<Vector2d>& polygon, std::size_t i) {
  return {polygon[i], polygon[(i + 1) % polygon.size()]};
}

bool overlap(const std::vector<Vector2d>& a, const std::vector<Vector2d>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      if (distance_m(side(a, i), side(b, k)) < from_furniture_m) return true;
    }
  }
  return false;
}

class Furnisher {
 public:
  Furnisher(const FloorLayout& layout, const FloorStyle& style, const std::vector<Segment>& ways)
      : layout_(layout), style_(style), ways_(ways), random_(style.seed, "floor furniture") {}

  std::vector<std::vector<Vector2d>> furnish() {
    for (const FloorCell& cell : layout_.cells) {
      Surroundings near = surroundings(cell);
      const double perimeter = 2 * cell.size().sum(), area = cell.size().prod();
      for (int i = pieces(perimeter / (cell.corridor ? 5 : 3)); i > 0; --i) against_wall(cell, near);
      if (!cell.corridor && area > hall_m2) {
        for (int i = pieces(area / 20); i > 0; --i) freely(cell, near);
      }
    }
    return std::move(furniture_);
  }

 private:
  int pieces(double usual) { return static_cast<int>(style_.furniture * usual * random_.uniform(0.6, 1.4)); }

  Surroundings surroundings(const FloorCell& cell) const {
    Surroundings near;
    const auto beside = [&](const Vector2d& low, const Vector2d& high) {
      return ((high - cell.low).array() > -1).all() && ((cell.high - low).array() > -1).all();
    };
    for (const Segment& way : ways_) {
      if (beside(way.a.cwiseMin(way.b), way.a.cwiseMax(way.b))) near.ways.push_back(way);
    }
    for (const FloorDoor& door : layout_.doors) {
      const Vector2d middle = layout_.borders[door.border].point(door.along);
      if (beside(middle, middle)) near.doors.push_back(middle);
    }
    return near;
  }

  void against_wall(const FloorCell& cell, Surroundings& near) {
    const bool corridor = cell.corridor;
    const double depth = corridor ? random_.uniform(0.15, 0.35) : random_.uniform(0.4, 0.9);
    const double width = corridor ? random_.uniform(0.4, 1.6) : random_.uniform(0.6, 2);
    const int across = corridor ? (cell.along_x ? 1 : 0) : static_cast<int>(random_.index(2));
    const double inset = half_wall_m + 0.5 * depth;
    Vector2d centre, extent;
    centre[across] = random_.chance(0.5) ? cell.low[across] + inset : cell.high[across] - inset;
    centre[1 - across] = random_.uniform(cell.low[1 - across], cell.high[1 - across]);
    extent[across] = depth;
    extent[1 - across] = width;
    const double askew = !corridor && random_.chance(0.2) ? random_.normal(0.1) : 0;
    place(cell, near, box(centre, extent.x(), extent.y(), askew));
  }

  void freely(const FloorCell& cell, Surroundings& near) {
    const Vector2d centre(random_.uniform(cell.low.x(), cell.high.x()),
                          random_.uniform(cell.low.y(), cell.high.y()));
    if (random_.chance(0.4)) {
      place(cell, near, disc(centre, random_.uniform(0.15, 0.3)));
    } else {
      const double width = random_.uniform(1, 2.4), depth = random_.uniform(0.6, 1.2);
      const double yaw = random_.chance(0.5) ? 0 : random_.uniform(0, std::numbers::pi);
      place(cell, near, box(centre, width, depth, yaw));
    }
  }

  void place(const FloorCell& cell, Surroundings& near, std::vector<Vector2d> polygon) {
    const double clearance = cell.corridor ? from_corridor_ways_m : from_ways_m;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Segment edge = side(polygon, i);
      if ((edge.a.array() < cell.low.array()).any() || (edge.a.array() > cell.high.array()).any()) return;
      const auto too_near = [&](const Segment& way) { return distance_m(edge, way) < clearance; };
      const auto blocks = [&](const Vector2d& door) { return distance_m(door, edge) < from_doors_m; };
      if (std::ranges::any_of(near.ways, too_near) || std::ranges::any_of(near.doors, blocks)) return;
    }
    const auto touches = [&](const std::vector<Vector2d>& other) { return overlap(polygon, other); };
    if (std::ranges::any_of(near.furniture, touches)) return;
    near.furniture.push_back(polygon);
    furniture_.push_back(std::move(polygon));
  }

  const FloorLayout& layout_;
  const FloorStyle& style_;
  const std::vector<Segment>& ways_;
  Random random_;
  std::vector<std::vector<Vector2d>> furniture_;
};

}  // namespace

std::vector<std::vector<Vector2d>> furnish(const FloorLayout& layout, const FloorStyle& style,
                                           const std::vector<Segment>& ways) {
  return Furnisher(layout, style, ways).furnish();
}

}  // namespace isthmus
