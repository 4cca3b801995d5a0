#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// An occupancy grid, map_server convention: row 0 is the top (largest y).
struct OccupancyGrid {
  static constexpr std::uint8_t free = 254;
  static constexpr std::uint8_t unknown = 205;
  static constexpr std::uint8_t occupied = 0;

  double resolution_m = 0.05;
  double origin_x_m = 0;  ///< of the lower-left corner of the lower-left pixel
  double origin_y_m = 0;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< row by row from the top
};

/// Renders one island from its patches, at their poses in the map copy. Free is what the free space of some
/// patch covers, by the very polygons of the patches; occupied is what scans hit, unless clearly contradicted
/// by other patches' free space. Fixed tags leave no trace. The grid is bounded to `max_pixels` by coarsening
/// the resolution.
OccupancyGrid render_island(const MapCopy& map, const std::vector<PatchId>& island_patches,
                            double resolution_m = 0.05, std::size_t max_pixels = 64'000'000);

}  // namespace isthmus
