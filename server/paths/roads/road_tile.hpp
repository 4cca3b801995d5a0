#pragma once

#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "server/paths/ground/tile_surface.hpp"
#include "server/paths/ground/zones.hpp"

namespace isthmus {

/// What a robot needs around its centre, in metres.
struct Footprint {
  double radius_m = 0.25;
  double clearance_m = 0.1;  ///< more than that from walls
};

/// A straight way through a cell passes its centre by half its diagonal at most.
inline constexpr double off_centre_m = 0.5 * std::numbers::sqrt2 * ground_cell_m;

/// A square of a layer: its number among those of a tile or in a roadmap; -1: none.
using SquareId = std::int32_t;

/// Where on a tile a footprint fits: its cells, joined to squares of 20 cm a side at most. A function of the
/// tile's surface and of how far its leaders are from one another along relations. Nodes are the tile's.
struct RoadTile {
  std::shared_ptr<const TileSurface> surface;
  std::vector<SquareId> square;                       ///< by node
  std::vector<NodeId> middle;                         ///< by square: one of its cells, which stands for it
  std::vector<std::pair<SquareId, SquareId>> beside;  ///< squares that one steps between, each way round
  /// By node: so many cells in rows and columns around it are of the tile, the footprint fits on them, they
  /// are of one layer only, and stepping comes to them.
  std::vector<std::uint8_t> open_cells;
};

/// It fits nowhere in `kept_out`.
RoadTile make_road_tile(std::shared_ptr<const TileSurface> surface, const Footprint& footprint,
                        const KeptOutCells& kept_out, const NearPatches& near);

}  // namespace isthmus
