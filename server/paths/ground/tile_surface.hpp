#pragma once

#include <memory>
#include <vector>

#include "server/paths/ground/gaps.hpp"
#include "server/paths/ground/ground_window.hpp"

namespace isthmus {

/// Distances to walls and to the unseen are known up to this.
inline constexpr double measured_reach_m = 1.2;

/// What the ground is like on one tile, by the tile's layers: a function of the tile, of the eight around it,
/// and of how far their leaders are from one another along relations.
struct TileSurface {
  std::shared_ptr<const GroundTile> tile;       ///< with its gaps filled
  std::vector<float> wall_m;                    ///< as `Ground::wall_m`
  std::vector<float> unseen_m;                  ///< as `Ground::unseen_m`
  std::vector<std::uint8_t> borders_on_unseen;  ///< whether one of the four cells beside it is unseen
};

/// How far around a tile its gaps, and then its surface, depend on what lies there, in cells.
inline constexpr int gap_margin_cells = static_cast<int>(max_gap_m / ground_cell_m) + 2;
inline constexpr int measured_margin_cells = static_cast<int>(measured_reach_m / ground_cell_m) + 2;
static_assert(measured_margin_cells < ground_tile_cells && gap_margin_cells < ground_tile_cells);

/// The tile with layers in its gaps (`find_gaps`); null: it has none.
std::shared_ptr<const GroundTile> with_gaps(const TilesAround& tiles, const NearPatches& near);

/// Of tiles with their gaps filled; `tile` is the one in the middle.
TileSurface measure_surface(std::shared_ptr<const GroundTile> tile, const TilesAround& tiles,
                            const NearPatches& near);

}  // namespace isthmus
