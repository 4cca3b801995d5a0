#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/paths/ground/near_patches.hpp"
#include "server/paths/ground/patch_raster.hpp"

namespace isthmus {

/// Cells a side of a tile.
inline constexpr int ground_tile_cells = 128;
static_assert((ground_tile_cells & (ground_tile_cells - 1)) == 0);

/// The row or column of tiles that a row or column of cells lies in.
constexpr std::int32_t tile_of(std::int32_t cell) {
  const std::int32_t within = cell & (ground_tile_cells - 1);
  return (cell - within) / ground_tile_cells;
}

/// A cell of a layer: its number among those of a tile, a window or an island's ground; -1: none.
using NodeId = std::int32_t;

/// What one stretch of the map says of a cell.
struct Layer {
  PatchId leader;  ///< of the patches of the stretch that see the cell, the one with the nearest origin
  bool occupied = false;  ///< by what patches of the leader's part see
  bool is_gap = false;    ///< nobody has seen it, and it is free by what lies around it: see `find_gaps`

  bool operator==(const Layer&) const = default;
};

/// A patch as it lies on a tile.
struct TilePatch {
  PatchId id;
  std::shared_ptr<const PatchRaster> raster;
  PatchId part;  ///< of the map, that scans hold together (scan_parts.hpp)
};

/// The layers of a square of cells. `low` is its first cell.
struct GroundTile {
  Cell low;
  std::vector<std::uint32_t> first;  ///< by cell, row by row; one more than there are cells
  std::vector<Layer> layers;

  /// Cells by their place within the tile.
  static std::size_t index(int x, int y) {
    return static_cast<std::size_t>(y) * ground_tile_cells + static_cast<std::size_t>(x);
  }
};

/// A tile's place on the plane: its row and column among tiles.
using TilePlace = std::pair<std::int32_t, std::int32_t>;

inline TilePlace place_of(const GroundTile& tile) { return {tile_of(tile.low.y), tile_of(tile.low.x)}; }

/// The cells from `low` to before `high`.
struct CellBox {
  Cell low, high;
};

/// Where two tiles at one place differ; nothing where they are the same.
std::optional<CellBox> difference(const GroundTile& one, const GroundTile& other);

/// Which of a tile's patches are near one another, row by row.
std::vector<std::uint8_t> near_pairs(std::span<const TilePatch> patches, const NearPatches& near);

/// The layers of a tile's cells: the nearest patch that sees a cell leads a layer, with which go all patches
/// near it along relations; of the rest, the nearest leads the next. `patches` by id, `near` their pairs.
GroundTile make_ground_tile(const Cell& low, std::span<const TilePatch> patches,
                            std::span<const std::uint8_t> near);

}  // namespace isthmus
