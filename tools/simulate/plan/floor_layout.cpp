#include "tools/simulate/plan/floor_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr double min_block_m = 4.5;                 // between two corridors
constexpr double min_room_side_m = 2.4;             // side of a room
constexpr double min_ring_m = 17;                   // side of a floor with a ring of corridors
constexpr double door_middle_from_corner_m = 0.85;  // its middle

// A rectangle that is yet to be divided, and on which sides a corridor runs along it.
struct Region {
  Vector2d low, high;
  bool west = false, east = false, south = false, north = false;
};

// Divides a floor by corridors into blocks, and those into rooms.
class FloorPlanner {
 public:
  explicit FloorPlanner(const FloorStyle& style) : style_(style), random_(style.seed, "floor layout") {
    corridor_m_ = style.corridor_m > 0 ? style.corridor_m : random_.uniform(1.9, 2.8);
    room_m_ = style.room_m > 0 ? style.room_m : random_.uniform(4.2, 7);
    block_m_ = random_.uniform(1.8, 2.3) * room_m_;
    const double width = std::sqrt(style.area_m2 * random_.uniform(1.05, 2.2));
    layout_.size = {width, style.area_m2 / width};
  }

  FloorLayout plan() {
    const Region floor{Vector2d::Zero(), layout_.size};
    const bool room_for_ring = layout_.size.minCoeff() >= min_ring_m;
    const bool drawn = random_.chance(0.7);
    if (style_.corridors == Corridors::ring ||
        (style_.corridors == Corridors::any && room_for_ring && drawn)) {
      ring(floor);
    } else {
      cut(floor, false);
    }
    return std::move(layout_);
  }

 private:
  double width() { return corridor_m_ * random_.uniform(0.9, 1.15); }

  void corridor(const Vector2d& low, const Vector2d& high, bool along_x) {
    layout_.cells.push_back({low, high, true, along_x});
  }

  // Corridors all round, rooms outside them on at least three sides, and what they enclose divided further.
  void ring(const Region& floor) {
    const double deepest = std::min(1.2 * room_m_, 0.25 * layout_.size.minCoeff());
    std::array<double, 4> bands;  // west, south, east, north
    for (double& band : bands) band = random_.uniform(0.7, 1) * deepest;
    if (random_.chance(0.4)) bands[random_.index(4)] = 0;
    const Vector2d low = floor.low + Vector2d(bands[0], bands[1]);
    const Vector2d high = floor.high - Vector2d(bands[2], bands[3]);
    const Vector2d in_low = low + Vector2d(width(), width()), in_high = high - Vector2d(width(), width());
    corridor(low, {high.x(), in_low.y()}, true);
    corridor({low.x(), in_high.y()}, high, true);
    corridor({low.x(), in_low.y()}, {in_low.x(), in_high.y()}, false);
    corridor({in_high.x(), in_low.y()}, {high.x(), in_high.y()}, false);
    rooms(floor.low, {floor.high.x(), low.y()});
    rooms({floor.low.x(), high.y()}, floor.high);
    rooms({floor.low.x(), low.y()}, {low.x(), high.y()});
    rooms({high.x(), low.y()}, {floor.high.x(), high.y()});
    divide({in_low, in_high, true, true, true, true});
  }

  void divide(const Region& region) {
    const Vector2d size = region.high - region.low;
    const bool wide = size.x() >= size.y();
    const double longer = size.maxCoeff(), shorter = size.minCoeff();
    const bool small = longer <= block_m_ || (shorter <= block_m_ && longer <= 2.2 * block_m_);
    for (const bool upright : {wide, !wide}) {
      const bool reached = upright ? region.south || region.north : region.west || region.east;
      const double extent = upright ? size.x() : size.y();
      if (small || !reached || extent < 2 * min_block_m + 1.15 * corridor_m_) continue;
      cut(region, upright);
      return;
    }
    rooms(region.low, region.high);
  }

  // A corridor through a region, and what it leaves on both sides.
  void cut(const Region& region, bool upright) {
    const int across = upright ? 0 : 1;
    const double corridor_m = width();
    const double rest = region.high[across] - region.low[across] - corridor_m;
    const double least = std::min(min_block_m, 0.5 * rest);
    const double from =
        region.low[across] + std::clamp(random_.uniform(0.35, 0.65) * rest, least, rest - least);
    Region below = region, above = region;
    below.high[across] = from;
    above.low[across] = from + corridor_m;
    (upright ? below.east : below.north) = true;
    (upright ? above.west : above.south) = true;
    Vector2d low = region.low, high = region.high;
    low[across] = from;
    high[across] = from + corridor_m;
    corridor(low, high, !upright);
    divide(below);
    divide(above);
  }

  void rooms(const Vector2d& low, const Vector2d& high) {
    const Vector2d size = high - low;
    const double longer = size.maxCoeff(), shorter = size.minCoeff();
    if (shorter < 0.1) return;
    const bool hall = shorter > 5 && size.prod() < 130 && random_.chance(style_.hall_share);
    if (hall || longer <= room_m_ || longer < 2 * min_room_side_m) {
      layout_.cells.push_back({low, high});
      return;
    }
    const int across = size.x() >= size.y() ? 0 : 1;
    const double at =
        std::clamp(random_.uniform(0.3, 0.7) * longer, min_room_side_m, longer - min_room_side_m) +
        low[across];
    Vector2d middle_high = high, middle_low = low;
    middle_high[across] = middle_low[across] = at;
    rooms(low, middle_high);
    rooms(middle_low, high);
  }

  const FloorStyle& style_;
  Random random_;
  double corridor_m_ = 0;
  double room_m_ = 0;
  double block_m_ = 0;
  FloorLayout layout_;
};

// The border of two cells that touch along the given axis, if it has any length.
void add_border(const FloorLayout& layout, std::size_t a, std::size_t b, std::vector<FloorBorder>& borders) {
  const FloorCell &p = layout.cells[a], &q = layout.cells[b];
  for (const int across : {0, 1}) {
    const int along = 1 - across;
    const double from = std::max(p.low[along], q.low[along]), to = std::min(p.high[along], q.high[along]);
    if (to - from < 1e-6) continue;
    for (const auto& [at, other] :
         {std::pair(p.high[across], q.low[across]), {p.low[across], q.high[across]}})
      if (std::abs(at - other) < 1e-9) borders.push_back({a, b, across == 0, at, from, to});
  }
}

// Opens doors until every room that can be reached is.
class Joiner {
 public:
  Joiner(FloorLayout& layout, const FloorStyle& style)
      : layout_(layout), random_(style.seed, "floor doors"), reached_(layout.cells.size(), false) {
    for (std::size_t i = 0; i < layout.cells.size(); ++i) reached_[i] = layout.cells[i].corridor;
  }

  void join() {
    while (reach_further()) {
    }
    for (std::size_t i = 0; i < layout_.borders.size(); ++i) {
      const FloorBorder& border = layout_.borders[i];
      const bool is_open =
          std::ranges::any_of(layout_.doors, [i](const FloorDoor& d) { return d.border == i; });
      if (is_open || !fits(border)) continue;
      const double size =
          std::max(layout_.cells[border.a].size().prod(), layout_.cells[border.b].size().prod());
      if (random_.chance(size > 45 ? 0.5 : 0.12)) open(i);
    }
  }

 private:
  bool fits(const FloorBorder& border) const {
    const bool both = layout_.cells[border.a].corridor && layout_.cells[border.b].corridor;
    return !both && border.length() > 2 * door_middle_from_corner_m + 0.1;
  }

  void open(std::size_t i) {
    const FloorBorder& border = layout_.borders[i];
    const double along =
        random_.uniform(border.from + door_middle_from_corner_m, border.to - door_middle_from_corner_m);
    layout_.doors.push_back({i, along, random_.uniform(1.0, 1.3)});
  }

  // One door for each room beside what was reached before.
  bool reach_further() {
    std::vector<std::vector<std::size_t>> ways_in(layout_.cells.size());
    for (std::size_t i = 0; i < layout_.borders.size(); ++i) {
      const FloorBorder& border = layout_.borders[i];
      if (reached_[border.a] == reached_[border.b] || !fits(border)) continue;
      ways_in[reached_[border.a] ? border.b : border.a].push_back(i);
    }
    bool any = false;
    for (std::size_t cell = 0; cell < ways_in.size(); ++cell) {
      if (ways_in[cell].empty()) continue;
      open(ways_in[cell][random_.index(ways_in[cell].size())]);
      reached_[cell] = any = true;
    }
    return any;
  }

  FloorLayout& layout_;
  Random random_;
  std::vector<bool> reached_;
};

}  // namespace

void find_borders(FloorLayout& layout) {
  for (std::size_t a = 0; a < layout.cells.size(); ++a) {
    for (std::size_t b = a + 1; b < layout.cells.size(); ++b) add_border(layout, a, b, layout.borders);
  }
}

FloorLayout lay_out_floor(const FloorStyle& style) {
  FloorLayout layout = FloorPlanner(style).plan();
  find_borders(layout);
  Joiner(layout, style).join();
  return layout;
}

std::vector<Wall> walls_of(const FloorLayout& layout) {
  const Vector2d& size = layout.size;
  std::vector<Wall> walls{{{{0, 0}, {size.x(), 0}, size, {0, size.y()}}, true, {}}};
  for (std::size_t i = 0; i < layout.borders.size(); ++i) {
    const FloorBorder& border = layout.borders[i];
    if (layout.cells[border.a].corridor && layout.cells[border.b].corridor) continue;
    Wall wall{{border.point(border.from), border.point(border.to)}, false, {}};
    for (const FloorDoor& door : layout.doors) {
      if (door.border == i) wall.doors.push_back({door.along - border.from, door.width_m});
    }
    walls.push_back(std::move(wall));
  }
  return walls;
}

}  // namespace isthmus
