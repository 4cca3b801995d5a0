#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/output/grid/lattice.hpp"

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

/// A patch, and where it is on its island.
struct PlacedPatch {
  const Patch& patch;
  Pose map_from_patch;
};

/// A rectangle along the axes of an island's frame, in metres; empty at first.
struct MapBox {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());

  void include(const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

/// Whether a patch is drawn on grids: fixed tags are not, and nothing is at a pose that is no place.
bool is_on_grid(const PlacedPatch& placed);

/// Of all that a patch leaves on a grid.
MapBox box_on_grid(const PlacedPatch& placed);

/// The cells of a lattice row by row from the top, as `render_island` has them; patches may reach beyond it.
std::vector<std::uint8_t> render_cells(std::span<const PlacedPatch> placed, const Lattice& lattice);

/// What a grid of an island covers, but for the cells around it: all that its patches leave; a point where
/// they leave nothing.
MapBox island_box(const MapCopy& map, const std::vector<PatchId>& island_patches);

/// Renders one island from its patches, at their poses in the map copy. Free is what the free space of some
/// patch covers, by the very polygons of the patches; occupied is what scans hit, unless clearly contradicted
/// by other patches' free space. Fixed tags leave no trace. The grid is bounded to `max_pixels` by coarsening
/// the resolution.
OccupancyGrid render_island(const MapCopy& map, const std::vector<PatchId>& island_patches,
                            double resolution_m = 0.05, std::size_t max_pixels = 64'000'000);

}  // namespace isthmus
