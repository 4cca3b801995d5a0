#pragma once

#include "server/output/grid/grid.hpp"
#include "server/output/pictures/layout.hpp"

namespace isthmus {

/// The part of an island's plane that a sheet shows: its grid, and around that as much as what is drawn
/// beside the grid needs. Lengths are in cells of the grid.
struct MapFrame {
  CellScale cells;
  int width = 0;
  int height = 0;
  int left = 0;  ///< beside the grid; a whole number of pixels
  int top = 0;
  Eigen::Vector2d left_top_m = Eigen::Vector2d::Zero();
  double pixels_per_m = 1;

  double width_px() const { return pixels(width); }
  double height_px() const { return pixels(height); }
  /// Of the grid, from the frame's left top.
  Eigen::Vector2d grid_px() const { return {pixels(left), pixels(top)}; }

 private:
  double pixels(int n) const;
};

/// Height of a line of text on a sheet with a map of that size, in pixels.
double em_of(double width_px, double height_px);

/// Holds all points of a box with a mark at each; an empty box: the grid alone. What is farther from the grid
/// than the grid is long (or 30 m) is not held: a single point would make the map a dot.
MapFrame map_frame(const OccupancyGrid& grid, const MapBox& held);

}  // namespace isthmus
