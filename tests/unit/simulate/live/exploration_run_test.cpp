#include "tools/simulate/live/exploration_run.hpp"

#include <gtest/gtest.h>

#include "tools/simulate/live/reachable_ground.hpp"

namespace isthmus {
namespace {

/// Two rooms of 4 m with a doorway between them, and so many robots in the first.
Scenario two_rooms(std::size_t robots) {
  Building building;
  building.walls.push_back({{{0, 0}, {8, 0}, {8, 4}, {0, 4}}, true, {}});
  building.walls.push_back({{{4, 0}, {4, 4}}, false, {{2, 1}}});
  Scenario scenario;
  scenario.name = "two_rooms";
  scenario.plan = build_floor_plan(building);
  for (std::size_t i = 0; i < robots; ++i) {
    RobotPlan robot;
    robot.name = "R" + std::to_string(i + 1);
    robot.barcode = 101 + static_cast<int>(i);
    robot.start = {1, 1, 0};
    scenario.robots.push_back(robot);
  }
  return scenario;
}

TEST(ReachableGround, IsWhereARobotsCentreCanCome) {
  const FloorPlan plan = two_rooms(1).plan;
  const RayCaster caster(plan);
  const ReachableGround through(plan, caster, {1, 1}, 0.3), shut(plan, caster, {1, 1}, 0.6);
  EXPECT_NEAR(through.area_m2(), 2 * 3.2 * 3.3, 2);  // both rooms, a wall's half and .3 m less all round
  EXPECT_NEAR(shut.area_m2(), 2.7 * 2.7, 1.5);
}

TEST(ReachableGround, RobotsStartBesideOneAnotherWhereThereIsRoom) {
  const RayCaster caster(two_rooms(1).plan);
  const auto starts = starts_beside(caster, {1, 1}, 4, 0.4);
  ASSERT_EQ(starts.size(), 4U);
  for (std::size_t a = 0; a < starts.size(); ++a) {
    EXPECT_FALSE(caster.touches(starts[a], 0.4));
    for (std::size_t b = 0; b < a; ++b) EXPECT_GE((starts[a] - starts[b]).norm(), 0.89);
  }
  EXPECT_THROW(starts_beside(caster, {1, 1}, 40, 0.4), std::runtime_error);
}

TEST(ExplorationRun, ARobotExploresBothRoomsByItselfAndTouchesNothing) {
  ExplorationRunOptions options;
  options.max_s = 300;
  const ExplorationScore score = explore(two_rooms(1), 1, options);
  EXPECT_GE(score.share, 0.99);
  EXPECT_GT(score.found_s, 0);
  EXPECT_EQ(score.touched_walls, 0U);
  EXPECT_LT(score.way_m, 40);
}

/// A corridor of 20 m and three dead ends of it, all 1.2 m wide; robots start 6 m from one another.
Scenario comb(std::size_t robots) {
  Building building;
  std::vector<Eigen::Vector2d> corners{{0, 0}, {20, 0}, {20, 1.2}};
  for (const double x : {15.0, 10.0, 5.0})
    corners.insert(corners.end(), {{x + 1.2, 1.2}, {x + 1.2, 5}, {x, 5}, {x, 1.2}});
  corners.emplace_back(0, 1.2);
  building.walls.push_back({corners, true, {}});
  Scenario scenario = two_rooms(robots);
  scenario.plan = build_floor_plan(building);
  for (std::size_t i = 0; i < robots; ++i)
    scenario.robots[i].start = {2 + 6 * static_cast<double>(i), 0.6, 0};
  return scenario;
}

TEST(ExplorationRun, NarrowCorridorsThatRobotsSeeNoEndOfAreExplored) {
  ExplorationRunOptions options;
  options.max_s = 300;
  options.apart = true;
  const auto expect_explored = [&](std::size_t robots, std::uint64_t seed) {
    options.robots = robots;
    const ExplorationScore score = explore(comb(robots), seed, options);
    EXPECT_GE(score.share, 0.99) << robots << " robots, seed " << seed;
    EXPECT_EQ(score.touched_walls, 0U);
    EXPECT_EQ(score.touched_robots, 0U);
  };
  expect_explored(1, 1);
  for (const std::uint64_t seed : {1U, 2U, 3U}) expect_explored(2, seed);
}

double length_m(const Planner& planner, const std::vector<ManifoldPose>& way) {
  double length = 0;
  for (std::size_t i = 1; i < way.size(); ++i)
    length += (position(planner.project(way[i])) - position(planner.project(way[i - 1]))).norm();
  return length;
}

TEST(ExplorationRun, ViewsHaveTheWaysThatRobotsDrive) {
  ExplorationRunOptions options;
  options.max_s = 60;
  options.measure_period_s = 1;
  std::size_t ways = 0, bent = 0;
  explore(two_rooms(1), 1, options, [&](const ExplorationView& view) {
    const auto found = view.team.find("R1");
    if (found == view.team.end() || found->second.way.size() < 2 || !found->second.goal) return;
    const ExploringRobot& robot = found->second;
    ++ways;
    const auto at = [&](const ManifoldPose& pose) { return position(view.planner.project(pose)); };
    EXPECT_LT((at(robot.way.front()) - at(robot.pose)).norm(), 0.3) << view.time_s;
    EXPECT_LT((at(robot.way.back()) - at(*robot.goal)).norm(), 0.6) << view.time_s;
    bent += length_m(view.planner, robot.way) > (at(robot.way.back()) - at(robot.way.front())).norm() + 0.05;
  });
  EXPECT_GT(ways, 5U);
  EXPECT_GT(bent, 0U);
}

TEST(ExplorationRun, TheSameRunIsTheSameToTheLastBit) {
  ExplorationRunOptions options;
  options.robots = 2;
  options.max_s = 40;
  const ExplorationScore once = explore(two_rooms(2), 3, options), again = explore(two_rooms(2), 3, options);
  EXPECT_EQ(once.way_m, again.way_m);
  EXPECT_EQ(once.share, again.share);
}

}  // namespace
}  // namespace isthmus
