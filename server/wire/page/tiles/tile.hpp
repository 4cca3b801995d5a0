#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "server/output/grid/grid.hpp"

namespace isthmus {

/// Cells a side of a tile.
inline constexpr int tile_cells = 256;
/// Of a cell at zoom 0; each zoom below doubles it.
inline constexpr double finest_cell_m = 0.05;
/// At which a tile is 819 m wide.
inline constexpr int coarsest_zoom = -6;

/// A tile of an island's grid. Tiles count from the origin of the island's frame, x to the right and y
/// downwards, so that tile (0, -1) has the origin at its lower left corner.
struct TileKey {
  int zoom = 0;
  int x = 0;
  int y = 0;

  auto operator<=>(const TileKey&) const = default;
};

/// The tile of the zoom below that a tile is a quarter of.
TileKey parent(const TileKey& key);

/// The four quarters of a tile, row by row from the top.
std::array<TileKey, 4> quarters(const TileKey& key);

/// The tiles of zoom 0 that a box has a part in, first and last. A box of no size or none has one at most.
std::pair<TileKey, TileKey> tiles_under(const MapBox& box);

/// The pixels of a tile in map_server's greys, packed: most tiles are large areas of few values.
class TilePixels {
 public:
  TilePixels() = default;
  /// Of tile_cells² pixels, row by row from the top.
  explicit TilePixels(std::span<const std::uint8_t> pixels);

  /// Unknown all over where nothing was packed.
  std::vector<std::uint8_t> unpack() const;

 private:
  struct Run {
    std::uint16_t more = 0;  ///< pixels behind the first
    std::uint8_t value = 0;
  };
  std::vector<Run> runs_;
};

/// A tile of zoom 0, of patches that may reach beyond it.
std::vector<std::uint8_t> render_tile(std::span<const PlacedPatch> placed, const TileKey& key);

/// A tile of its quarters at half their size. Of four cells, an occupied one is shown, else a free one: walls
/// stay whole.
std::vector<std::uint8_t> join_quarters(const std::array<std::vector<std::uint8_t>, 4>& pixels);

}  // namespace isthmus
