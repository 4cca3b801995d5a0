#include "server/wire/page/tiles/tile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

constexpr std::size_t tile_pixels = std::size_t{tile_cells} * tile_cells;

/// Half, rounded downwards.
constexpr int half(int coordinate) { return coordinate >> 1; }

int tile_of(double coordinate_m) {
  return static_cast<int>(std::floor(coordinate_m / (tile_cells * finest_cell_m)));
}

}  // namespace

TileKey parent(const TileKey& key) { return {key.zoom - 1, half(key.x), half(key.y)}; }

std::array<TileKey, 4> quarters(const TileKey& key) {
  const int zoom = key.zoom + 1;
  const int x = 2 * key.x;
  const int y = 2 * key.y;
  return {TileKey{zoom, x, y}, {zoom, x + 1, y}, {zoom, x, y + 1}, {zoom, x + 1, y + 1}};
}

std::pair<TileKey, TileKey> tiles_under(const MapBox& box) {
  // Downwards: the highest y is in the first row of tiles.
  return {{0, tile_of(box.low.x()), -tile_of(box.high.y()) - 1},
          {0, tile_of(box.high.x()), -tile_of(box.low.y()) - 1}};
}

TilePixels::TilePixels(std::span<const std::uint8_t> pixels) {
  for (const std::uint8_t value : pixels) {
    const bool goes_on = !runs_.empty() && runs_.back().value == value &&
                         runs_.back().more < std::numeric_limits<std::uint16_t>::max();
    if (goes_on) {
      runs_.back().more += 1;
    } else {
      runs_.push_back({0, value});
    }
  }
}

std::vector<std::uint8_t> TilePixels::unpack() const {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(tile_pixels);
  for (const Run& run : runs_) pixels.insert(pixels.end(), std::size_t{run.more} + 1, run.value);
  pixels.resize(tile_pixels, OccupancyGrid::unknown);
  return pixels;
}

std::vector<std::uint8_t> render_tile(std::span<const PlacedPatch> placed, const TileKey& key) {
  const Lattice lattice{finest_cell_m, static_cast<double>(key.x) * tile_cells,
                        -(static_cast<double>(key.y) + 1) * tile_cells, tile_cells, tile_cells};
  return render_cells(placed, lattice);
}

std::vector<std::uint8_t> join_quarters(const std::array<std::vector<std::uint8_t>, 4>& pixels) {
  // By what is shown: occupied (0) before free (254) before unknown (205).
  const auto shown = [](std::uint8_t a, std::uint8_t b) {
    if (a == OccupancyGrid::occupied || b == OccupancyGrid::occupied) return OccupancyGrid::occupied;
    return std::max(a, b);
  };
  constexpr int half_cells = tile_cells / 2;
  std::vector<std::uint8_t> joined;
  joined.reserve(tile_pixels);
  for (int row = 0; row < tile_cells; ++row) {
    for (int column = 0; column < tile_cells; ++column) {
      const std::size_t quarter = (row < half_cells ? 0U : 2U) + (column < half_cells ? 0U : 1U);
      const int top_left = 2 * (row % half_cells) * tile_cells + 2 * (column % half_cells);
      const auto top = static_cast<std::size_t>(top_left);
      const std::vector<std::uint8_t>& from = pixels[quarter];
      joined.push_back(
          shown(shown(from[top], from[top + 1]), shown(from[top + tile_cells], from[top + tile_cells + 1])));
    }
  }
  return joined;
}

}  // namespace isthmus
