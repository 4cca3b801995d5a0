#include "tools/simulate/campaigns/explore/exploration_picture.hpp"

#include <string>
#include <vector>

#include "server/output/format/number.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/tables/islands.hpp"

namespace isthmus {
namespace {

SheetText text_of(const ExplorationView& view) {
  return {"Island 0", "exploration after " + fixed(view.time_s, 0) +
                          " s: robots, ways that they drive, places to look from"};
}

void draw_way(MapSheet& sheet, const ExplorationView& view, const std::vector<ManifoldPose>& way,
              const WayStyle& style) {
  std::vector<Eigen::Vector2d> points;
  for (const ManifoldPose& pose : way)
    points.push_back(sheet.window().pixels(position(view.planner.project(pose))));
  sheet.canvas().line(
      points, {.colour = style.colour, .width_px = way_line_px(sheet.window().em), .dashes = style.dashes});
}

}  // namespace

std::optional<MapSheet> exploration_sheet(const ExplorationView& view) {
  const RankedIslands islands = rank_islands(view.planner.map());
  if (islands.patches.empty()) return std::nullopt;
  const RelationGraph& graph = view.planner.map().graph;
  const IslandId island = graph.island(islands.patches[0].front());
  Legend legend;
  for (const auto& [name, robot] : view.team) legend.push_back(way_entry(name, way_style(legend.size())));
  MapSheet sheet(render_island(view.planner.map(), islands.patches[0]), text_of(view), legend);
  for (std::size_t i = 0; const auto& [name, robot] : view.team) {
    const WayStyle style = way_style(i++);
    if (graph.island(robot.pose.patch) != island) continue;
    draw_way(sheet, view, robot.way, style);
    if (robot.goal)
      draw_patch(sheet.canvas(), sheet.window(), position(view.planner.project(*robot.goal)), style.colour);
    draw_end(sheet.canvas(), sheet.window(), view.planner.project(robot.pose), style);
  }
  return sheet;
}

}  // namespace isthmus
