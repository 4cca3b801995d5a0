#pragma once

#include <Eigen/Core>
#include <cmath>
#include <compare>
#include <cstdint>

namespace isthmus {

/// Of a cell's side, in metres: the resolution of the grids that are written.
inline constexpr double ground_cell_m = 0.05;

/// A square cell of an island's plane, counted from the origin of the island's frame.
struct Cell {
  std::int32_t x = 0;
  std::int32_t y = 0;

  auto operator<=>(const Cell&) const = default;
};

/// The cell that a point in metres lies in; the point's coordinates are below 1e7.
inline Cell cell_of(const Eigen::Vector2d& point_m) {
  return {static_cast<std::int32_t>(std::floor(point_m.x() / ground_cell_m)),
          static_cast<std::int32_t>(std::floor(point_m.y() / ground_cell_m))};
}

/// In metres.
inline Eigen::Vector2d centre_of(const Cell& cell) {
  return Eigen::Vector2d(cell.x + 0.5, cell.y + 0.5) * ground_cell_m;
}

}  // namespace isthmus
