#include "tools/simulate/live/drive_picture.hpp"

#include <array>
#include <cstdio>

#include "server/output/format/number.hpp"
#include "server/output/pictures/map_sheet.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/pictures/way_pen.hpp"
#include "tools/simulate/truth/plan_picture.hpp"

namespace isthmus {
namespace {

void mark(OccupancyGrid& grid, const Eigen::Vector2d& point) {
  const int column = static_cast<int>((point.x() - grid.origin_x_m) / grid.resolution_m);
  const int row = grid.height - 1 - static_cast<int>((point.y() - grid.origin_y_m) / grid.resolution_m);
  if (column < 0 || row < 0 || column >= grid.width || row >= grid.height) return;
  grid.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.width) +
              static_cast<std::size_t>(column)] = OccupancyGrid::free;
}

OccupancyGrid seen_grid(const FloorPlan& plan, const ReachableGround& ground, const SeenGround& seen) {
  OccupancyGrid grid = plain_grid(plan, OccupancyGrid::unknown);
  const double half = 0.5 * ReachableGround::spacing_m;
  for (std::size_t i = 0; i < seen.seen().size(); ++i) {
    if (!seen.seen()[i]) continue;
    for (double dx = -half; dx <= half; dx += 0.5 * half)  // no finer than cells, or some would be missed
      for (double dy = -half; dy <= half; dy += 0.5 * half)
        mark(grid, ground.points()[i] + Eigen::Vector2d(dx, dy));
  }
  return grid;
}

}  // namespace

void draw_drive(const FloorPlan& plan, const LiveTeam& team, const ReachableGround& ground,
                const SeenGround& seen, const std::string& directory) {
  Legend legend;
  for (std::size_t i = 0; i < team.size(); ++i) legend.push_back(way_entry(team[i].name(), way_style(i)));
  legend.push_back(start_entry());
  legend.push_back(end_entry());
  const std::string told = fixed(100 * seen.share(), 1) + " % of the ground seen after " +
                           fixed(team.time_s(), 0) + " s and " + fixed(team.way_m(), 0) + " m";
  MapSheet sheet(seen_grid(plan, ground, seen), {"The simulated building", told}, legend);
  draw_walls(sheet, plan);
  for (std::size_t i = 0; i < team.size(); ++i) {
    WayPen pen(sheet.canvas(), sheet.window(), way_style(i));
    for (const Eigen::Vector2d& point : team[i].trail) pen.to(point);
  }
  for (std::size_t i = 0; i < team.size(); ++i) {
    if (!team.truth()[i].poses.empty())
      draw_start(sheet.canvas(), sheet.window(), team.truth()[i].poses.front().world_from_robot,
                 way_style(i));
    draw_end(sheet.canvas(), sheet.window(), team[i].robot.world_from_robot(), way_style(i));
  }
  char file[32];
  std::snprintf(file, sizeof file, "/drive-%05.0f.png", team.time_s());
  sheet.write(directory + file);
}

}  // namespace isthmus
