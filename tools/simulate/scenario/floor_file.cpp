#include "tools/simulate/scenario/floor_file.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

#include "tools/simulate/plan/floor_furniture.hpp"
#include "tools/simulate/plan/floor_layout.hpp"
#include "tools/simulate/plan/floor_tours.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr int first_floor_barcode = 101;
constexpr double wait_at_end_s = 8;

struct FloorOrder {
  FloorStyle style;
  int robots = 2;
  double tour_m = 0;
  double roughness_m = 0.004;
};

FloorOrder read_floor(const Setting& setting) {
  Fields fields(setting);
  FloorOrder order;
  FloorStyle& style = order.style;
  fields.read_within("area_m2", style.area_m2, 100, 1e5);
  fields.read_within("seed", style.seed, 0, std::numeric_limits<std::int64_t>::max());
  std::string corridors(word(style.corridors));
  fields.read("corridors", corridors);
  const std::optional<Corridors> known = value_of<Corridors>(corridors);
  if (!known) fail_at(fields.where(), "'corridors' must be \"any\", \"ring\" or \"spine\"");
  style.corridors = *known;
  if (style.corridors == Corridors::ring && style.area_m2 < 400)
    fail_at(fields.where(), "a floor with a ring of corridors has at least 400 square metres");
  if (fields.has("corridor_m")) fields.read_within("corridor_m", style.corridor_m, 1.8, 4);
  if (fields.has("room_m")) fields.read_within("room_m", style.room_m, 3.5, 12);
  fields.read_within("hall_share", style.hall_share, 0, 1);
  fields.read_within("furniture", style.furniture, 0, 10);
  fields.read_within("robots", order.robots, 1, 1000);
  fields.read_within("tour_m", order.tour_m, 0, 1e6);
  fields.read_within("roughness_m", order.roughness_m, 0, 1);
  fields.finish();
  return order;
}

RobotPlan robot_of(const FloorTour& tour, int number, const RobotPlan& common) {
  RobotPlan plan = common;
  plan.name = "R" + std::to_string(number);
  plan.barcode = first_floor_barcode + number - 1;
  plan.start = tour.start;
  for (const Vector2d& point : tour.waypoints) plan.tour.push_back(Waypoint{point});
  plan.tour.push_back(Wait{wait_at_end_s});
  return plan;
}

std::vector<Segment> ways_of(const std::vector<FloorTour>& tours) {
  std::vector<Segment> ways;
  for (const FloorTour& tour : tours) {
    Vector2d at(tour.start.x, tour.start.y);
    for (const Vector2d& point : tour.waypoints) {
      ways.push_back({at, point});
      at = point;
    }
  }
  return ways;
}

// What the scenario says of single robots.
void lay_over(const Setting& table, std::vector<RobotFromFile>& robots) {
  const auto* changes = std::get_if<Setting::Table>(&table.value);
  if (changes == nullptr) fail_at(table.where, "'robots' must be a table of robots");
  for (const auto& [name, setting] : *changes) {
    const auto robot = std::ranges::find(robots, name, [](const RobotFromFile& r) { return r.plan.name; });
    if (robot == robots.end()) fail_at(setting.where, "the floor has no robot '" + name + "'");
    RobotFromFile changed = read_robot(name, setting, robot->plan);
    if (changed.step_where.empty()) changed.step_where = robot->step_where;
    *robot = std::move(changed);
  }
}

}  // namespace

FloorFromFile make_floor(const Setting& floor, const Setting* robots, const RobotPlan& common) {
  const FloorOrder order = read_floor(floor);
  if (common.laps != 1) fail_at(floor.where, "a floor's tours are driven once: laps must be 1");
  const FloorLayout layout = lay_out_floor(order.style);
  std::vector<FloorTour> tours;
  try {
    tours = plan_tours(layout, order.style, order.robots, order.tour_m);
  } catch (const std::runtime_error& error) {
    fail_at(floor.where, error.what());
  }
  FloorFromFile made;
  made.building.walls = walls_of(layout);
  made.building.furniture = furnish(layout, order.style, ways_of(tours));
  made.building.roughness_m = order.roughness_m;
  made.building.seed = order.style.seed;
  for (const FloorTour& tour : tours) {
    RobotFromFile robot{robot_of(tour, static_cast<int>(made.robots.size()) + 1, common), {}};
    robot.step_where.assign(robot.plan.tour.size(), floor.where);
    made.robots.push_back(std::move(robot));
  }
  if (robots != nullptr) lay_over(*robots, made.robots);
  return made;
}

}  // namespace isthmus
