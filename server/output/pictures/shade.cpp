#include "server/output/pictures/shade.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

struct Counts {
  int walls = 0;
  int free = 0;
  int all = 0;
};

Counts count(const OccupancyGrid& grid, int left, int top, int side) {
  Counts counts;
  for (int row = top; row < std::min(top + side, grid.height); ++row) {
    const std::uint8_t* cells =
        grid.pixels.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.width);
    for (int column = left; column < std::min(left + side, grid.width); ++column) {
      counts.walls += cells[column] == OccupancyGrid::occupied ? 1 : 0;
      counts.free += cells[column] == OccupancyGrid::free ? 1 : 0;
      ++counts.all;
    }
  }
  return counts;
}

Rgb mix(Rgb a, Rgb b, double share_of_b) {
  const auto one = [&](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + (to - from) * share_of_b));
  };
  return {one(a.red, b.red), one(a.green, b.green), one(a.blue, b.blue)};
}

/// A wall through a block of n² cells has about n of them.
Rgb colour(const Counts& counts, int side) {
  if (counts.all == 0) return ink::unknown;
  const int others = counts.all - counts.walls;
  const Rgb ground =
      others == 0 ? ink::wall : mix(ink::unknown, ink::floor, static_cast<double>(counts.free) / others);
  return mix(ground, ink::wall, std::min(1.0, static_cast<double>(counts.walls) / side));
}

}  // namespace

Image shade(const OccupancyGrid& grid, int cells_per_pixel) {
  const int side = std::max(1, cells_per_pixel);
  Image image{(grid.width + side - 1) / side, (grid.height + side - 1) / side, {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column)
      image.pixels.push_back(colour(count(grid, column * side, row * side, side), side));
  return image;
}

}  // namespace isthmus
