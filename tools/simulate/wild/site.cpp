#include "tools/simulate/wild/site.hpp"

#include <algorithm>
#include <cmath>

#include "tools/simulate/run/unicycle.hpp"
#include "tools/simulate/wild/bend.hpp"
#include "tools/simulate/wild/layout.hpp"
#include "tools/simulate/wild/surfaces.hpp"
#include "tools/simulate/wild/tours.hpp"

namespace isthmus {
namespace {

constexpr int first_wild_barcode = 101;

RobotPlan robot_of(const WildDraw& draw, std::size_t i, WildTourPlan tour) {
  const WildRobot& drawn = draw.robots[std::min(i, draw.robots.size() - 1)];
  RobotPlan robot;
  robot.name = "R" + std::to_string(i + 1);
  robot.silent = i >= draw.robots.size();
  robot.barcode = robot.silent ? -1 : first_wild_barcode + static_cast<int>(i);
  robot.start = tour.start;
  robot.start_s = robot.silent ? 0 : drawn.start_s;
  robot.tour = std::move(tour.steps);
  robot.drive = drawn.drive;
  robot.laser = drawn.laser;
  robot.odometry = drawn.odometry;
  robot.camera = draw.camera;
  return robot;
}

void add_driven(const RobotPlan& robot, std::uint64_t seed, std::vector<Eigen::Vector2d>& driven) {
  constexpr std::size_t stride = 5;
  const TruePath path = drive(robot, seed);
  const auto& poses = path.stretches().front().world_from_robot;
  for (std::size_t i = 0; i < poses.size(); i += stride) driven.push_back(position(poses[i]));
}

// About when the first robot is done.
double duration_s(const WildDraw& draw) {
  return draw.tour.loop_m * draw.tour.laps / draw.robots.front().drive.speed_mps;
}

}  // namespace

Scenario make_wild_scenario(const WildDraw& draw) {
  const WildLayout layout = lay_out_wild(draw.building, draw.seed);
  const Bend bend(draw.building, layout.floor.size, draw.seed);
  Scenario scenario;
  scenario.name = "wild";
  scenario.summary = describe(draw);
  scenario.bodies_visible = true;
  scenario.false_sightings = draw.false_sightings;
  WildUse use;
  for (WildTourPlan& tour : plan_wild_tours(draw, layout, bend)) {
    use.ways.insert(use.ways.end(), tour.ways.begin(), tour.ways.end());
    use.entered.insert(tour.rooms.begin(), tour.rooms.end());
    scenario.robots.push_back(robot_of(draw, scenario.robots.size(), std::move(tour)));
    add_driven(scenario.robots.back(), draw.seed, use.driven);
  }
  scenario.robots_give_way = scenario.robots.size() > 1;
  std::vector<FloorPlan> plans = build_wild(draw, layout, bend, use);
  scenario.plan = std::move(plans.front());
  for (std::size_t i = 1; i < plans.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(plans.size());
    scenario.changes.push_back({share * duration_s(draw), std::move(plans[i])});
  }
  return scenario;
}

SimulatedRun simulate_wild(const WildDraw& draw, const Scenario& scenario) {
  SimulatedRun run = simulate(scenario, draw.seed);
  for (std::size_t i = 0; i < draw.robots.size(); ++i)
    spoil_wheels(run, scenario.robots[i].name, draw.robots[i].faults, draw.seed);
  return run;
}

}  // namespace isthmus
