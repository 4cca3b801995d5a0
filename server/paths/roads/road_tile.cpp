#include "server/paths/roads/road_tile.hpp"

#include <algorithm>
#include <utility>

#include "server/paths/ground/patch_raster.hpp"

namespace isthmus {
namespace {

constexpr std::int32_t square_side_cells = 4;
static_assert(ground_tile_cells % square_side_cells == 0, "a square lies on one tile");
/// Where a robot has driven, the unseen is nowhere nearer than that.
constexpr double max_from_unseen_m = stood_m - ground_cell_m;
constexpr SquareId none = -1;
constexpr SquareId free = -2;  // of no square yet

bool in_one_square(const Cell& a, const Cell& b) {
  const auto part = [](std::int32_t cell) { return cell & ~(square_side_cells - 1); };
  return part(a.x) == part(b.x) && part(a.y) == part(b.y);
}

class RoadTileMaker {
 public:
  RoadTileMaker(std::shared_ptr<const TileSurface> surface, const NearPatches& near)
      : window_(TilesAround{{nullptr, nullptr, nullptr, nullptr, surface->tile.get()}}, 0, near) {
    tile_.surface = std::move(surface);
  }

  RoadTile make(const Footprint& footprint, const KeptOutCells& kept_out) {
    find_room(footprint, kept_out);
    for (NodeId node = 0; node < size(); ++node)
      if (square(node) == free) flood(node);
    find_beside();
    find_open();
    return std::move(tile_);
  }

 private:
  NodeId size() const { return static_cast<NodeId>(window_.size()); }
  SquareId& square(NodeId node) { return tile_.square[static_cast<std::size_t>(node)]; }
  bool fits(NodeId node) { return square(node) != none; }
  float wall_m(NodeId node) const { return tile_.surface->wall_m[static_cast<std::size_t>(node)]; }

  void find_room(const Footprint& footprint, const KeptOutCells& kept_out) {
    const auto from_walls = static_cast<float>(footprint.radius_m + footprint.clearance_m + off_centre_m);
    const auto from_unseen = static_cast<float>(std::min(footprint.radius_m, max_from_unseen_m));
    tile_.square.reserve(window_.size());
    for (NodeId node = 0; node < size(); ++node) {
      const bool fits = !window_.occupied(node) && wall_m(node) >= from_walls &&
                        tile_.surface->unseen_m[static_cast<std::size_t>(node)] >= from_unseen &&
                        !kept_out.contains(window_.cell(node));
      tile_.square.push_back(fits ? free : none);
    }
  }

  void flood(NodeId start) {
    const auto number = static_cast<SquareId>(tile_.middle.size());
    std::vector<NodeId> members{start};
    square(start) = number;
    for (std::size_t i = 0; i < members.size(); ++i) {
      visit_beside(window_.cell(members[i]), [&](const Cell& beside) {
        if (!in_one_square(window_.cell(start), beside)) return;
        const NodeId next = window_.step(members[i], beside);
        if (next < 0 || square(next) != free) return;
        square(next) = number;
        members.push_back(next);
      });
    }
    tile_.middle.push_back(*std::max_element(members.begin(), members.end(),
                                             [this](NodeId a, NodeId b) { return wall_m(a) < wall_m(b); }));
  }

  void find_beside() {
    std::vector<std::vector<SquareId>> beside(tile_.middle.size());
    const auto add = [&](SquareId from, SquareId to) {
      std::vector<SquareId>& own = beside[static_cast<std::size_t>(from)];
      if (std::ranges::find(own, to) == own.end()) own.push_back(to);
    };
    for (NodeId node = 0; node < size(); ++node) {
      if (!fits(node)) continue;
      visit_beside(window_.cell(node), [&](const Cell& other) {
        if (in_one_square(window_.cell(node), other)) return;
        const NodeId next = window_.step(node, other);
        if (next < 0 || !fits(next)) return;
        add(square(node), square(next));
        add(square(next), square(node));
      });
    }
    for (std::size_t from = 0; from < beside.size(); ++from)
      for (const SquareId to : beside[from]) tile_.beside.emplace_back(static_cast<SquareId>(from), to);
  }

  /// Whether stepping from a cell to any of the eight beside it comes to the only layer there is, on which
  /// the footprint fits. Of cells beyond the tile that is not known here.
  bool is_open(NodeId node) {
    if (!fits(node) || window_.only(window_.cell(node)) != node) return false;
    bool open = true;
    visit_beside(window_.cell(node), [&](const Cell& beside) {
      const NodeId next = window_.only(beside);
      open = open && next >= 0 && fits(next) && window_.step(node, beside) == next;
    });
    return open;
  }

  /// From where something is near outwards, ring by ring.
  void find_open() {
    constexpr std::uint8_t unreached = 255;
    static_assert(ground_tile_cells / 2 < unreached);
    tile_.open_cells.assign(window_.size(), unreached);
    std::vector<NodeId> wave;
    for (NodeId node = 0; node < size(); ++node) {
      if (is_open(node)) continue;
      tile_.open_cells[static_cast<std::size_t>(node)] = 0;
      wave.push_back(node);
    }
    for (std::uint8_t ring = 1; !wave.empty(); ++ring) {
      std::vector<NodeId> next_wave;
      for (const NodeId node : wave) {
        visit_beside(window_.cell(node), [&](const Cell& beside) {
          const NodeId next = window_.only(beside);
          if (next < 0 || tile_.open_cells[static_cast<std::size_t>(next)] != unreached) return;
          tile_.open_cells[static_cast<std::size_t>(next)] = ring;
          next_wave.push_back(next);
        });
      }
      wave = std::move(next_wave);
    }
  }

  GroundWindow window_;
  RoadTile tile_;
};

}  // namespace

RoadTile make_road_tile(std::shared_ptr<const TileSurface> surface, const Footprint& footprint,
                        const KeptOutCells& kept_out, const NearPatches& near) {
  return RoadTileMaker(std::move(surface), near).make(footprint, kept_out);
}

}  // namespace isthmus
