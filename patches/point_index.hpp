#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "patches/scan.hpp"

namespace isthmus {

/// Nearest scan point in constant time: a sparse grid of tiles around the points, each cell holding the point
/// nearest to its centre. The answer is nearest to within half a cell's diagonal, which point-to-line
/// matching does not notice. Only points with a normal are in it.
class PointIndex {
 public:
  static constexpr double cell_m = 0.1;
  static constexpr double reach_m = 0.40;   ///< cells farther than this from every point answer "none"
  static constexpr double horizon_m = 250;  ///< points farther from the robot along x or y are left out

  PointIndex() = default;
  explicit PointIndex(std::span<const ScanPoint> points);

  /// Index into the points, or -1 where none is near.
  int nearest(const Eigen::Vector2d& position) const;

 private:
  static constexpr int tile_cells = 8;
  static constexpr double tile_m = cell_m * tile_cells;

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int tiles_x_ = 0;
  int tiles_y_ = 0;
  std::vector<std::int32_t> tile_start_;  ///< per tile: offset of its cells, or -1
  std::vector<std::int16_t> cells_;
};

}  // namespace isthmus
