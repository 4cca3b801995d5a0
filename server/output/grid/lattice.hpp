#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace isthmus {

/// The plane of an island cut into square cells, which lie on whole multiples of the resolution whatever the
/// island's extent. Columns count from the left, rows from the bottom.
struct Lattice {
  double resolution_m = 0.05;
  double column0 = 0;  ///< of the lower-left corner, in cells from the map's origin
  double row0 = 0;
  int width = 0;
  int height = 0;

  /// Coordinates in cells; (0, 0) is the lower-left corner.
  Eigen::Vector2d cells(const Eigen::Vector2d& map_point) const {
    return map_point / resolution_m - Eigen::Vector2d(column0, row0);
  }
  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
};

}  // namespace isthmus
