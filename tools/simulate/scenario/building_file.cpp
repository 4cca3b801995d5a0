#include "tools/simulate/scenario/building_file.hpp"

#include <limits>
#include <numbers>

namespace isthmus {
namespace {

Wall read_wall(const Setting& setting) {
  Fields fields(setting);
  Wall wall;
  wall.corners = as_points(fields.require("corners"), 2, "at least two [x, y]");
  fields.read("closed", wall.closed);
  if (const Setting* doors = fields.find("doors")) {
    for (const Setting& door : as_list(*doors, "a list of [distance along the wall, width]")) {
      const auto n = as_numbers(door, 2, "[distance along the wall, width] in metres");
      wall.doors.push_back({n[0], n[1]});
    }
  }
  fields.finish();
  return wall;
}

void read_furniture(Fields& fields, Building& building) {
  if (const Setting* polygons = fields.find("polygons")) {
    for (const Setting& polygon : as_list(*polygons, "a list of polygons")) {
      building.furniture.push_back(as_points(polygon, 3, "at least three [x, y]"));
    }
  }
  if (const Setting* boxes = fields.find("boxes")) {
    for (const Setting& setting : as_list(*boxes, "a list of boxes")) {
      const auto n = as_numbers(setting, 5, "[x, y, width, depth, yaw] in metres and degrees");
      building.furniture.push_back(box({n[0], n[1]}, n[2], n[3], n[4] * std::numbers::pi / 180));
    }
  }
  if (const Setting* pillars = fields.find("pillars")) {
    for (const Setting& pillar : as_list(*pillars, "a list of pillars")) {
      const auto n = as_numbers(pillar, 3, "[x, y, radius] in metres");
      building.furniture.push_back(disc({n[0], n[1]}, n[2]));
    }
  }
}

Clutter read_clutter(const Setting& setting) {
  Fields fields(setting);
  Clutter clutter;
  fields.read_within("count", clutter.count, 0, 1'000'000'000);
  fields.read_within("size_min_m", clutter.size_min_m, 0.01, 100);
  fields.read_within("size_max_m", clutter.size_max_m, 0.01, 100);
  fields.read_within("clearance_m", clutter.clearance_m, 0, 100);
  fields.finish();
  return clutter;
}

}  // namespace

std::pair<Building, Clutter> read_building(const Setting& setting) {
  Fields fields(setting);
  Building building;
  Clutter clutter;
  for (const Setting& wall : as_list(fields.require("walls"), "a list of walls")) {
    building.walls.push_back(read_wall(wall));
  }
  read_furniture(fields, building);
  fields.read_within("wall_thickness_m", building.wall_thickness_m, 0, 10);
  fields.read_within("roughness_m", building.roughness_m, 0, 1);
  fields.read_within("facet_m", building.facet_m, 0.05, 1000);
  fields.read_within("glossy_share", building.glossy_share, 0, 1);
  fields.read_degrees("glossy_incidence_deg", building.glossy_incidence_rad);
  fields.read_within("seed", building.seed, 0, std::numeric_limits<std::int64_t>::max());
  if (const Setting* table = fields.find("clutter")) clutter = read_clutter(*table);
  fields.finish();
  return {std::move(building), clutter};
}

}  // namespace isthmus
