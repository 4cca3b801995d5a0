#include "tools/simulate/wild/layout.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr double min_room_m = 2.4;
constexpr double min_door_border_m = 1.9;
constexpr double door_from_corner_m = 0.9;

/// What lies between corridors, and on which sides they run along it.
struct Block {
  Vector2d low, high;
  bool west = false, east = false, south = false, north = false;

  Vector2d size() const { return high - low; }
};

/// Where the door of a room should be.
enum class DoorSide : std::uint8_t { none, along_x, along_y, all };

/// A corridor along y: the piece between two corridors along x, or a wing.
struct Branch {
  double from_x = 0;
  double low_y = 0, high_y = 0;
};

class Architect {
 public:
  Architect(const WildBuilding& plan, std::uint64_t seed)
      : plan_(plan), random_(seed, "wild layout"), width_m_(plan.corridor_m) {}

  WildLayout lay_out() {
    place_corridors();
    fill_storeys();
    made_.floor.size = size_;
    made_.first_yard = made_.floor.cells.size();
    std::ranges::copy(yards_, std::back_inserter(made_.floor.cells));
    find_borders(made_.floor);
    for (std::size_t cell = 0; cell < sides_.size(); ++cell) open_doors(cell);
    return std::move(made_);
  }

 private:
  double band() { return random_.chance(0.75) ? plan_.room_depth_m : 0; }
  double middle(double low) const { return low + 0.5 * width_m_; }

  void place_corridors() {
    const bool single = plan_.corridors_along_x == 1;
    west_ = band();
    const double east = band(), south = band(), north = band();
    const double reach = single && plan_.corridors_along_y > 0 ? plan_.wing_m : 0;
    for (int i = 0; i < plan_.corridors_along_x; ++i) {
      const double share = single ? 0 : static_cast<double>(i) / (plan_.corridors_along_x - 1);
      rows_.push_back(std::max(south, reach) + share * plan_.width_m);
    }
    size_ = {west_ + plan_.length_m + width_m_ + east, rows_.back() + width_m_ + std::max(north, reach)};
    if (single) {
      place_wings();
    } else {
      place_columns();
      choose_loops();
    }
    const double end = west_ + plan_.length_m + width_m_, lobby = single ? width_m_ : 0;
    for (const double row : rows_) corridor({west_ + lobby, row}, {end - lobby, row + width_m_}, true);
    if (!single) return;
    corridor({west_, rows_[0]}, {west_ + lobby, rows_[0] + width_m_}, false);
    corridor({end - lobby, rows_[0]}, {end, rows_[0] + width_m_}, false);
  }

  void place_columns() {
    const int count = plan_.corridors_along_y;
    for (int i = 0; i < count; ++i) {
      const double askew = i == 0 || i + 1 == count ? 0 : random_.uniform(-0.2, 0.2);
      columns_.push_back(west_ + plan_.length_m * (i + askew) / (count - 1));
    }
    for (std::size_t row = 0; row + 1 < rows_.size(); ++row) {
      for (std::size_t i = 0; i < columns_.size(); ++i) {
        const bool outer = i == 0 || i + 1 == columns_.size();
        if (outer || random_.chance(0.8))
          branches_.push_back({columns_[i], rows_[row] + width_m_, rows_[row + 1]});
      }
    }
  }

  // From end to end of the corridor, into each wing on the way; or of a corridor without wings.
  void place_wings() {
    const double y = middle(rows_[0]);
    std::vector<Vector2d> there{{middle(west_), y}};
    for (int i = 0; i < plan_.corridors_along_y; ++i) {
      const double x = west_ + plan_.length_m * (i + random_.uniform(0.2, 0.8)) / plan_.corridors_along_y;
      const bool up = random_.chance(0.5);
      const double reach = plan_.wing_m - 1;
      const double above = rows_[0] + width_m_;
      branches_.push_back(up ? Branch{x, above, above + reach} : Branch{x, rows_[0] - reach, rows_[0]});
      there.emplace_back(middle(x), up ? above + reach : rows_[0] - reach);
    }
    there.emplace_back(middle(west_ + plan_.length_m), y);
    made_.loops.push_back(std::move(there));
  }

  void choose_loops() {
    const auto loop = [&](double x, double to_x, double y, double to_y) {
      made_.loops.push_back({{middle(x), middle(y)},
                             {middle(to_x), middle(y)},
                             {middle(to_x), middle(to_y)},
                             {middle(x), middle(to_y)}});
    };
    loop(columns_.front(), columns_.back(), rows_.front(), rows_.back());
    for (std::size_t i = 0; i + 1 < columns_.size() && columns_.size() > 2; ++i)
      loop(columns_[i], columns_[i + 1], rows_.front(), rows_.back());
  }

  void corridor(const Vector2d& low, const Vector2d& high, bool along_x) {
    made_.floor.cells.push_back({low, high, true, along_x});
    sides_.push_back(DoorSide::none);
  }

  void room(const Vector2d& low, const Vector2d& high, DoorSide side) {
    if ((high - low).minCoeff() < 0.1) return;
    made_.floor.cells.push_back({low, high});
    sides_.push_back(side);
  }

  void yard(const Vector2d& low, const Vector2d& high) {
    if ((high - low).minCoeff() > 0.1) yards_.push_back({low, high});
  }

  // The floor between, below and above the corridors along x.
  void fill_storeys() {
    const double east = west_ + plan_.length_m + width_m_;
    storey(0, rows_[0], false, true);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      yard({0, rows_[i]}, {west_, rows_[i] + width_m_});
      yard({east, rows_[i]}, {size_.x(), rows_[i] + width_m_});
      const bool last = i + 1 == rows_.size();
      storey(rows_[i] + width_m_, last ? size_.y() : rows_[i + 1], true, !last);
    }
  }

  void storey(double low, double high, bool south, bool north) {
    if (high - low < 0.1) return;
    double x = 0;
    bool west = false;
    for (const Branch& branch : branches_) {
      if (branch.low_y < low - 1e-9 || branch.high_y > high + 1e-9) continue;
      fill({{x, low}, {branch.from_x, high}, west, true, south, north});
      branch_off(branch, low, high);
      yard({branch.from_x, low}, {branch.from_x + width_m_, branch.low_y});
      yard({branch.from_x, branch.high_y}, {branch.from_x + width_m_, high});
      x = branch.from_x + width_m_;
      west = true;
    }
    fill({{x, low}, {size_.x(), high}, west, false, south, north});
  }

  // A wing ends in a lobby, so that the routes have a node there.
  void branch_off(const Branch& branch, double low, double high) {
    const double from_x = branch.from_x, to_x = from_x + width_m_;
    const bool blind_below = branch.low_y > low + 1e-9, blind_above = branch.high_y < high - 1e-9;
    const double from_y = branch.low_y + (blind_below ? width_m_ : 0);
    const double to_y = branch.high_y - (blind_above ? width_m_ : 0);
    corridor({from_x, from_y}, {to_x, to_y}, false);
    if (blind_below) corridor({from_x, branch.low_y}, {to_x, from_y}, true);
    if (blind_above) corridor({from_x, to_y}, {to_x, branch.high_y}, true);
  }

  // Rooms along its corridors, and a yard in what is left; or one hall, or one yard.
  void fill(Block block) {
    if (block.size().minCoeff() < 0.1) return;
    const bool outer = !(block.south && block.north) && !(block.west && block.east);
    if (!outer && random_.chance(plan_.yard_share)) return yard(block.low, block.high);
    if (block.size().minCoeff() > 5 && block.size().maxCoeff() < 35 && random_.chance(plan_.hall_share))
      return room(block.low, block.high, DoorSide::all);
    carve(block, 1);
    carve(block, 0);
    yard(block.low, block.high);
  }

  // Cuts the strips of rooms off that lie along the corridors on the two sides across an axis.
  void carve(Block& block, int across) {
    const bool below = across == 1 ? block.south : block.west, above = across == 1 ? block.north : block.east;
    const double deep = block.size()[across];
    if ((!below && !above) || block.size().minCoeff() < 0.1) return;
    const int strips = below && above && deep >= 2 * min_room_m ? 2 : 1;
    const bool all = deep < strips * plan_.room_depth_m + 1.5;
    const double depth = all ? deep / strips : plan_.room_depth_m;
    Vector2d high = block.high, low = block.low;
    high[across] = block.low[across] + depth;
    low[across] = block.high[across] - depth;
    if (below) strip(block.low, high, 1 - across);
    if (above && (strips == 2 || !below)) strip(low, block.high, 1 - across);
    if (below) block.low[across] += depth;
    if (above && (strips == 2 || !below)) block.high[across] -= depth;
  }

  void strip(const Vector2d& low, const Vector2d& high, int along) {
    const bool alike = plan_.kind == WildKind::repeated;
    const auto side = along == 0 ? DoorSide::along_x : DoorSide::along_y;
    const double length = high[along] - low[along];
    const double each = length / std::max(1.0, std::round(length / plan_.room_m));
    double at = low[along];
    while (at < high[along] - 1e-6) {
      double next = at + (alike ? each : plan_.room_m * random_.uniform(0.6, 1.6));
      if (high[along] - next < min_room_m) next = high[along];
      Vector2d room_low = low, room_high = high;
      room_low[along] = at;
      room_high[along] = next;
      room(room_low, room_high, alike || random_.chance(0.9) ? side : DoorSide::none);
      at = next;
    }
  }

  bool takes_door(std::size_t cell, const FloorBorder& border) const {
    const std::size_t other = border.a == cell ? border.b : border.a;
    if ((border.a != cell && border.b != cell) || !made_.floor.cells[other].corridor) return false;
    const DoorSide side = sides_[cell];
    const bool fits = side == DoorSide::all || (side == DoorSide::along_x) == !border.upright;
    // A door in a corridor's end has no lane that passes it.
    return fits && made_.floor.cells[other].along_x != border.upright && border.length() > min_door_border_m;
  }

  // One for a room, one on each side for a hall.
  void open_doors(std::size_t cell) {
    if (sides_[cell] == DoorSide::none) return;
    for (std::size_t i = 0; i < made_.floor.borders.size(); ++i) {
      const FloorBorder& border = made_.floor.borders[i];
      if (!takes_door(cell, border)) continue;
      const double share = plan_.kind == WildKind::repeated ? 0.3 : random_.uniform();
      const double from = border.from + door_from_corner_m, to = border.to - door_from_corner_m;
      made_.floor.doors.push_back({i, from + share * (to - from), random_.uniform(1.15, 1.4)});
      if (sides_[cell] != DoorSide::all) return;
    }
  }

  const WildBuilding& plan_;
  Random random_;
  double width_m_;
  double west_ = 0;
  Vector2d size_ = Vector2d::Zero();
  std::vector<double> rows_, columns_;  // where corridors begin
  std::vector<Branch> branches_;
  std::vector<DoorSide> sides_;  // by cell, yards excepted
  std::vector<FloorCell> yards_;
  WildLayout made_;
};

}  // namespace

WildLayout lay_out_wild(const WildBuilding& building, std::uint64_t seed) {
  return Architect(building, seed).lay_out();
}

}  // namespace isthmus
