#include "tools/simulate/truth/plan_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace isthmus {

OccupancyGrid plain_grid(const FloorPlan& plan, std::uint8_t value) {
  constexpr double margin_m = 0.5, max_cells_a_side = 4000;
  const Eigen::Vector2d size = plan.high - plan.low + Eigen::Vector2d::Constant(2 * margin_m);
  OccupancyGrid grid;
  grid.resolution_m = std::max(grid.resolution_m, size.maxCoeff() / max_cells_a_side);
  grid.origin_x_m = plan.low.x() - margin_m;
  grid.origin_y_m = plan.low.y() - margin_m;
  grid.width = static_cast<int>(std::ceil(size.x() / grid.resolution_m));
  grid.height = static_cast<int>(std::ceil(size.y() / grid.resolution_m));
  grid.pixels.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height), value);
  return grid;
}

void draw_walls(MapSheet& sheet, const FloorPlan& plan) {
  for (const Segment& segment : plan.segments)
    sheet.canvas().line(std::array{sheet.window().pixels(segment.a), sheet.window().pixels(segment.b)},
                        {.colour = ink::wall, .width_px = 1.5});
}

}  // namespace isthmus
