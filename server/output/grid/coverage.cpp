#include "server/output/grid/coverage.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

/// The first of `count` cells in a line whose centre is at or beyond a coordinate.
int first_cell(double coordinate, int count) {
  return static_cast<int>(std::clamp(std::ceil(coordinate - 0.5), 0.0, static_cast<double>(count)));
}

}  // namespace

void Coverage::add(const Polysolid& free_space, const Pose& map_from_patch) {
  for (const PolygonWithHoles& polygon : free_space.polygons()) {
    add_ring(polygon.outer, map_from_patch);
    for (const Ring& hole : polygon.holes) add_ring(hole, map_from_patch);
  }
}

void Coverage::add_ring(const Ring& ring, const Pose& map_from_patch) {
  if (ring.empty()) return;
  Eigen::Vector2d from = lattice_.cells(map_from_patch * ring.back());
  for (const Eigen::Vector2d& corner : ring) {
    const Eigen::Vector2d to = lattice_.cells(map_from_patch * corner);
    add_edge(from, to);
    from = to;
  }
}

void Coverage::add_edge(const Eigen::Vector2d& from_cells, const Eigen::Vector2d& to_cells) {
  const bool down = to_cells.y() < from_cells.y();  // a counter-clockwise ring's inside is to its right
  const Eigen::Vector2d& low = down ? to_cells : from_cells;
  const Eigen::Vector2d& high = down ? from_cells : to_cells;
  const int begin = first_cell(low.y(), lattice_.height);
  const int end = first_cell(high.y(), lattice_.height);
  if (begin == end) return;
  const double slope = (high.x() - low.x()) / (high.y() - low.y());
  for (int row = begin; row < end; ++row) {
    const int column = first_cell(low.x() + slope * (row + 0.5 - low.y()), lattice_.width);
    if (column < lattice_.width) steps_[lattice_.index(column, row)] += down ? 1 : -1;
  }
}

}  // namespace isthmus
