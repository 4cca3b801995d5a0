#include "server/output/pictures/map_frame.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

/// Lines of text on a picture that is shown in whole are then neither tiny nor huge.
constexpr double lines_a_side = 85;
constexpr double least_em = 13, most_em = 32;
/// For half a mark, the stroke to where a robot looks among them.
constexpr double mark_room_em = 1.7;
constexpr double least_reach_m = 30;

/// Cells beside a grid.
struct Sides {
  int left = 0, right = 0, top = 0, bottom = 0;
};

Sides sides_of(const OccupancyGrid& grid, const MapBox& held, double room_m) {
  if (!(held.low.x() <= held.high.x()) || !(held.low.y() <= held.high.y())) return {};
  const double most = std::max<double>(
      {least_reach_m / grid.resolution_m, static_cast<double>(grid.width), static_cast<double>(grid.height)});
  const auto cells = [&](double beyond_m) {
    return static_cast<int>(std::clamp(std::ceil((beyond_m + room_m) / grid.resolution_m), 0.0, most));
  };
  const double right_m = grid.origin_x_m + grid.width * grid.resolution_m;
  const double top_m = grid.origin_y_m + grid.height * grid.resolution_m;
  return {cells(grid.origin_x_m - held.low.x()), cells(held.high.x() - right_m), cells(held.high.y() - top_m),
          cells(grid.origin_y_m - held.low.y())};
}

MapFrame frame_of(const OccupancyGrid& grid, const Sides& sides) {
  MapFrame frame;
  frame.cells = cell_scale(sides.left + grid.width + sides.right, sides.top + grid.height + sides.bottom);
  const auto whole = [&](int n) {
    const int together = frame.cells.cells_per_pixel;
    return (n + together - 1) / together * together;
  };
  frame.left = whole(sides.left);
  frame.top = whole(sides.top);
  frame.width = frame.left + grid.width + sides.right;
  frame.height = frame.top + grid.height + sides.bottom;
  frame.left_top_m = {grid.origin_x_m - frame.left * grid.resolution_m,
                      grid.origin_y_m + (grid.height + frame.top) * grid.resolution_m};
  frame.pixels_per_m = frame.cells.pixels_per_m(grid.resolution_m);
  return frame;
}

}  // namespace

double MapFrame::pixels(int n) const {
  return std::ceil(static_cast<double>(n) / cells.cells_per_pixel) * cells.pixels_per_cell;
}

double em_of(double width_px, double height_px) {
  return std::clamp(std::max(width_px, height_px) / lines_a_side, least_em, most_em);
}

/// Marks are as large as text, which is as large as the sheet asks for: what room they need is known once the
/// points have theirs.
MapFrame map_frame(const OccupancyGrid& grid, const MapBox& held) {
  const MapFrame of_points = frame_of(grid, sides_of(grid, held, 0));
  const double em = em_of(of_points.width_px(), of_points.height_px());
  return frame_of(grid, sides_of(grid, held, mark_room_em * em / of_points.pixels_per_m));
}

}  // namespace isthmus
