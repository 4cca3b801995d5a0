#include "tools/simulate/wild/surfaces.hpp"

#include <algorithm>
#include <array>

#include "tools/simulate/plan/clutter.hpp"
#include "tools/simulate/plan/floor_furniture.hpp"
#include "tools/simulate/plan/random.hpp"
#include "tools/simulate/wild/degree.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

// Beams farther than this off its normal do not come back from a surface.
constexpr double glass_limit_rad = 5 * degree;
constexpr double dark_limit_rad = 40 * degree;
constexpr double facet_m = 0.5;
constexpr double passes_m = 0.3;  // of a robot's middle from furniture: its radius, and some more
constexpr double largest_piece_m = 3;

enum class Surface : std::uint8_t { plain, glass, dark };
constexpr std::size_t surfaces = 3;

using Polygon = std::vector<Vector2d>;

void append(FloorPlan& plan, const FloorPlan& more) {
  if (more.segments.empty()) return;
  const bool first = plan.segments.empty();
  plan.low = first ? more.low : plan.low.cwiseMin(more.low);
  plan.high = first ? more.high : plan.high.cwiseMax(more.high);
  plan.segments.insert(plan.segments.end(), more.segments.begin(), more.segments.end());
}

class Builder {
 public:
  Builder(const WildDraw& draw, const WildLayout& layout, const Bend& bend)
      : draw_(draw), layout_(layout), bend_(bend) {}

  FloorPlan walls() {
    Random random(draw_.seed, "wild surfaces");
    std::array<std::vector<Wall>, surfaces> of;
    const Vector2d& size = layout_.floor.size;
    const std::array<Vector2d, 4> corners{Vector2d(0, 0), {size.x(), 0}, size, {0, size.y()}};
    for (std::size_t i = 0; i < 4; ++i)
      of[index(surface(random, false))].push_back(wall(corners[i], corners[(i + 1) % 4]));
    for (std::size_t i = 0; i < layout_.floor.borders.size(); ++i) {
      const FloorBorder& border = layout_.floor.borders[i];
      if (layout_.floor.cells[border.a].corridor && layout_.floor.cells[border.b].corridor) continue;
      const bool to_yard = layout_.is_yard(border.a) || layout_.is_yard(border.b);
      auto& walls = of[index(surface(random, to_yard))];
      for (const auto& [from, to] : solid(i)) walls.push_back(wall(border.point(from), border.point(to)));
    }
    FloorPlan plan;
    for (std::size_t i = 0; i < surfaces; ++i) append(plan, built(std::move(of[i]), {}, limit(i)));
    return plan;
  }

  // Frames, pillars and radiators along the walls of corridors: no corridor of a real building is bare. And
  // trees in streets.
  FloorPlan fixtures(const WildUse& use) {
    Random random(draw_.seed, "wild fixtures");
    std::vector<Polygon> pieces;
    for (std::size_t i = 0; i < layout_.floor.borders.size(); ++i) {
      const FloorBorder& border = layout_.floor.borders[i];
      if (layout_.floor.cells[border.a].corridor == layout_.floor.cells[border.b].corridor) continue;
      for (const auto& [from, to] : solid(i)) add_fixtures(border, from, to, random, pieces);
    }
    for (const FloorBorder& side : outer_corridor_walls())
      add_fixtures(side, side.from, side.to, random, pieces);
    add_trees(Random(draw_.seed, "wild trees"), pieces);
    return furniture(bent(std::move(pieces), use));
  }

  // Of the doors that may be, those that chance closes.
  FloorPlan closed_doors(const std::set<std::size_t>& entered, Random& random) {
    std::vector<Wall> closed;
    for (const FloorDoor& door : layout_.floor.doors) {
      const FloorBorder& border = layout_.floor.borders[door.border];
      if (entered.contains(border.a) || entered.contains(border.b)) continue;
      if (!random.chance(draw_.building.closed_share)) continue;
      const double half = 0.5 * door.width_m;
      closed.push_back(wall(border.point(door.along - half), border.point(door.along + half)));
    }
    return built(std::move(closed), {}, std::numbers::pi);
  }

  FloorPlan furniture(const std::vector<Polygon>& pieces) const {
    return built({}, pieces, std::numbers::pi);
  }

  // No yard is furnished.
  std::vector<Polygon> pieces(const WildUse& use, std::uint64_t variant) const {
    FloorLayout inside = layout_.floor;
    inside.cells.resize(layout_.first_yard);
    FloorStyle style;
    style.seed = draw_.seed + 1'000'000'007 * variant;
    style.furniture = draw_.building.furniture;
    return bent(furnish(inside, style, use.ways), use);
  }

 private:
  static std::size_t index(Surface surface) { return static_cast<std::size_t>(surface); }
  static double limit(std::size_t surface) {
    return std::array{std::numbers::pi, glass_limit_rad, dark_limit_rad}[surface];
  }

  // Bent as the building; what stands in somebody's way is left out.
  std::vector<Polygon> bent(std::vector<Polygon> pieces, const WildUse& use) const {
    for (Polygon& piece : pieces)
      std::ranges::transform(piece, piece.begin(), [&](const Vector2d& corner) { return bend_(corner); });
    std::erase_if(pieces, [&](const Polygon& piece) {
      return std::ranges::any_of(use.driven, [&](const Vector2d& at) { return blocks(piece, at); });
    });
    return pieces;
  }

  // Of corridors that run along the building's outer wall.
  std::vector<FloorBorder> outer_corridor_walls() const {
    std::vector<FloorBorder> walls;
    for (std::size_t i = 0; i < layout_.first_yard; ++i) {
      const FloorCell& cell = layout_.floor.cells[i];
      if (!cell.corridor) continue;
      for (const int across : {0, 1}) {
        const double from = cell.low[1 - across], to = cell.high[1 - across];
        if (cell.low[across] < 1e-6) walls.push_back({i, i, across == 0, 0, from, to});
        const double end = layout_.floor.size[across];
        if (cell.high[across] > end - 1e-6) walls.push_back({i, i, across == 0, end, from, to});
      }
    }
    return walls;
  }

  void add_fixtures(const FloorBorder& wall, double from, double to, Random& random,
                    std::vector<Polygon>& pieces) const {
    const auto spacing_m = [&] { return draw_.building.fixture_m * random.uniform(0.5, 1.5); };
    for (double at = from + 0.5 * spacing_m(); at < to - 0.2; at += spacing_m())
      pieces.push_back(fixture(wall, at, random));
  }

  void add_trees(Random random, std::vector<Polygon>& pieces) const {
    for (std::size_t i = 0; i < layout_.first_yard; ++i) {
      const FloorCell& street = layout_.floor.cells[i];
      const double usual = draw_.building.trees_per_m2 * street.size().prod();
      for (int left = static_cast<int>(usual * random.uniform(0.6, 1.4)); left > 0; --left) {
        const Vector2d at(random.uniform(street.low.x(), street.high.x()),
                          random.uniform(street.low.y(), street.high.y()));
        pieces.push_back(disc(at, random.uniform(0.08, 0.35), 8));
      }
    }
  }

  // Half in the wall; stairs and porches of houses.
  Polygon fixture(const FloorBorder& border, double at, Random& random) const {
    const double size = draw_.building.kind == WildKind::campus ? 2.5 : 1;
    const double along = size * random.uniform(0.1, 1), across = 2 * size * random.uniform(0.08, 0.25);
    return border.upright ? box(border.point(at), across, along, 0) : box(border.point(at), along, across, 0);
  }

  static bool blocks(const Polygon& piece, const Vector2d& at) {
    if ((piece.front() - at).norm() > largest_piece_m + passes_m) return false;
    for (std::size_t i = 0; i < piece.size(); ++i)
      if (distance_m(at, {piece[i], piece[(i + 1) % piece.size()]}) < passes_m) return true;
    return false;
  }

  // Yards have more windows than rooms.
  Surface surface(Random& random, bool to_yard) const {
    const double share = random.uniform();
    const double glass = std::min(0.8, (to_yard ? 4 : 1) * draw_.building.glass_share);
    if (share < glass) return Surface::glass;
    return share < glass + draw_.building.dark_share ? Surface::dark : Surface::plain;
  }

  // What its doors leave of a border.
  std::vector<std::pair<double, double>> solid(std::size_t border) const {
    std::vector<FloorDoor> doors;
    std::ranges::copy_if(layout_.floor.doors, std::back_inserter(doors),
                         [border](const FloorDoor& door) { return door.border == border; });
    std::ranges::sort(doors, {}, &FloorDoor::along);
    std::vector<std::pair<double, double>> pieces;
    double at = layout_.floor.borders[border].from;
    for (const FloorDoor& door : doors) {
      pieces.emplace_back(at, door.along - 0.5 * door.width_m);
      at = door.along + 0.5 * door.width_m;
    }
    pieces.emplace_back(at, layout_.floor.borders[border].to);
    return pieces;
  }

  Wall wall(const Vector2d& from, const Vector2d& to) const {
    Wall wall;
    wall.corners.push_back(bend_(from));
    for (const Vector2d& corner : bend_.line(from, to, 2.0)) wall.corners.push_back(corner);
    return wall;
  }

  FloorPlan built(std::vector<Wall> walls, std::vector<Polygon> furniture, double limit_rad) const {
    Building building;
    building.walls = std::move(walls);
    building.furniture = std::move(furniture);
    building.roughness_m = draw_.building.roughness_m;
    building.facet_m = facet_m;
    building.glossy_share = limit_rad < std::numbers::pi ? 1 : 0;
    building.glossy_incidence_rad = limit_rad;
    building.seed = draw_.seed;
    return build_floor_plan(building);
  }

  const WildDraw& draw_;
  const WildLayout& layout_;
  const Bend& bend_;
};

}  // namespace

std::vector<FloorPlan> build_wild(const WildDraw& draw, const WildLayout& layout, const Bend& bend,
                                  const WildUse& use) {
  Builder builder(draw, layout, bend);
  FloorPlan walls = builder.walls();
  append(walls, builder.fixtures(use));
  std::vector<Polygon> pieces = builder.pieces(use, 0);
  std::vector<FloorPlan> plans;
  for (int change = 0; change <= draw.building.changes; ++change) {
    Random random(draw.seed, "wild change " + std::to_string(change));
    if (change > 0) {
      std::erase_if(pieces, [&](const Polygon&) { return random.chance(draw.building.moved_share); });
      for (Polygon& piece : builder.pieces(use, static_cast<std::uint64_t>(change)))
        if (random.chance(draw.building.moved_share)) pieces.push_back(std::move(piece));
    }
    FloorPlan plan = walls;
    append(plan, builder.closed_doors(use.entered, random));
    append(plan, builder.furniture(pieces));
    plans.push_back(std::move(plan));
  }
  return plans;
}

}  // namespace isthmus
