#pragma once

#include "server/output/pictures/map_sheet.hpp"
#include "tools/simulate/plan/floor_plan.hpp"

namespace isthmus {

/// A grid of the building's size, all of one value: walls are drawn on it as lines.
OccupancyGrid plain_grid(const FloorPlan& plan, std::uint8_t value);

void draw_walls(MapSheet& sheet, const FloorPlan& plan);

}  // namespace isthmus
