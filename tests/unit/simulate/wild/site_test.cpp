#include "tools/simulate/wild/site.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tools/simulate/wild/layout.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

// The smallest run there is among the first seeds, so that it is quick to simulate.
WildDraw a_small_draw(std::size_t robots) {
  for (std::uint64_t seed = 1;; ++seed) {
    WildDraw draw = draw_wild(seed);
    if (draw.robots.size() == robots && draw.tour.loop_m * draw.tour.laps < 70 &&
        draw.robots[0].laser.beams < 300)
      return draw;
  }
}

TEST(WildSite, SameSeedSameLog) {
  const WildDraw draw = a_small_draw(1);
  const Scenario scenario = make_wild_scenario(draw), again = make_wild_scenario(draw);
  const SimulatedRun one = simulate_wild(draw, scenario), same = simulate_wild(draw, again);
  ASSERT_EQ(one.events.size(), same.events.size());
  for (std::size_t i = 0; i < one.events.size(); ++i) {
    const auto *a = std::get_if<ScanEvent>(&one.events[i].body),
               *b = std::get_if<ScanEvent>(&same.events[i].body);
    ASSERT_EQ(a == nullptr, b == nullptr);
    ASSERT_EQ(one.events[i].receive_utime, same.events[i].receive_utime);
    if (a != nullptr) {
      ASSERT_EQ(a->scan.ranges_m, b->scan.ranges_m);
      ASSERT_EQ(a->scan.utime, b->scan.utime);
    }
  }
}

TEST(WildSite, RobotsHaveWhatWasDrawnAndPeopleAreSilent) {
  std::uint64_t seed = 1;
  while (draw_wild(seed).people == 0 || draw_wild(seed).robots.size() < 2) ++seed;
  const WildDraw draw = draw_wild(seed);
  const Scenario scenario = make_wild_scenario(draw);
  ASSERT_EQ(scenario.robots.size(), draw.robots.size() + static_cast<std::size_t>(draw.people));
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    EXPECT_EQ(scenario.robots[i].silent, i >= draw.robots.size());
    if (scenario.robots[i].silent) continue;
    EXPECT_EQ(scenario.robots[i].laser.beams, draw.robots[i].laser.beams);
    EXPECT_EQ(scenario.robots[i].odometry.angular_scale, draw.robots[i].odometry.angular_scale);
    EXPECT_EQ(scenario.robots[i].barcode, 101 + static_cast<int>(i));
  }
}

TEST(WildSite, ABuildingThatChangesIsFoundOtherwiseLater) {
  std::uint64_t seed = 1;
  while (draw_wild(seed).building.changes < 2) ++seed;
  const Scenario scenario = make_wild_scenario(draw_wild(seed));
  ASSERT_GE(scenario.changes.size(), 2U);
  EXPECT_GT(scenario.changes[0].from_s, 20);
  EXPECT_GT(scenario.changes[1].from_s, scenario.changes[0].from_s);
  const auto ends = [](const FloorPlan& plan) {
    double sum = 0;
    for (const Segment& segment : plan.segments) sum += segment.a.sum();
    return sum;
  };
  EXPECT_NE(ends(scenario.plan), ends(scenario.changes[0].plan));
  EXPECT_NE(ends(scenario.changes[0].plan), ends(scenario.changes[1].plan));
}

TEST(WildSite, GlassGivesNoReturnAtASlant) {
  std::uint64_t seed = 1;
  while (draw_wild(seed).building.glass_share <= 0.05) ++seed;
  const Scenario scenario = make_wild_scenario(draw_wild(seed));
  const auto glass = std::ranges::count_if(
      scenario.plan.segments, [](const Segment& segment) { return segment.return_limit_rad < 0.1; });
  EXPECT_GT(glass, 10);
  EXPECT_LT(static_cast<std::size_t>(glass), scenario.plan.segments.size() / 2);
}

// Frames and pillars reach into corridors that have no furniture.
TEST(WildSite, NoCorridorIsBare) {
  WildDraw draw = a_small_draw(1);
  draw.building.furniture = draw.building.bend_rad = draw.building.roughness_m = 0;
  draw.building.bend = WildBend::straight;
  draw.building.fixture_m = 2;
  const WildLayout layout = lay_out_wild(draw.building, draw.seed);
  const Scenario scenario = make_wild_scenario(draw);
  const double half_m = 0.5 * layout.floor.size.y();  // the middle of a bent building lies at y = 0
  for (std::size_t i = 0; i < layout.first_yard; ++i) {
    const FloorCell& cell = layout.floor.cells[i];
    if (!cell.corridor || cell.size().maxCoeff() < 8) continue;
    const auto inside = [&](const Segment& segment) {
      const Vector2d middle = 0.5 * (segment.a + segment.b) + Vector2d(0, half_m);
      return ((middle - cell.low).array() > 0.07).all() && ((cell.high - middle).array() > 0.07).all();
    };
    EXPECT_GE(std::ranges::count_if(scenario.plan.segments, inside), cell.size().maxCoeff() / 4) << i;
  }
}

TEST(WildSite, TreesOfACampusStandInNobodysWay) {
  std::uint64_t seed = 1;
  while (draw_wild(seed, WildPlace::campus).building.trees_per_m2 < 0.005) ++seed;
  WildDraw draw = draw_wild(seed, WildPlace::campus);
  const Scenario with_trees = make_wild_scenario(draw);
  draw.building.trees_per_m2 = 0;
  EXPECT_GT(with_trees.plan.segments.size(), make_wild_scenario(draw).plan.segments.size() + 100);
  for (const RobotPlan& robot : with_trees.robots) {
    Vector2d last = position(robot.start);
    for (const auto& step : robot.tour) {
      const auto* to = std::get_if<Waypoint>(&step);
      if (to == nullptr) continue;
      const double length_m = (to->position - last).norm();
      for (double along = 0; along < length_m; along += 0.5) {
        const Vector2d at = last + along / length_m * (to->position - last);
        for (const auto& segment : with_trees.plan.segments) ASSERT_GT(distance_m(at, segment), 0.25);
      }
      last = to->position;
    }
  }
}

TEST(WildLayout, RoomsOfARepeatedBuildingAreAlike) {
  std::uint64_t seed = 1;
  while (draw_wild(seed).building.kind != WildKind::repeated) ++seed;
  const WildDraw draw = draw_wild(seed);
  const WildLayout layout = lay_out_wild(draw.building, draw.seed);
  std::size_t alike = 0, rooms = 0;
  for (std::size_t i = 1; i < layout.first_yard; ++i) {
    if (layout.floor.cells[i].corridor || layout.floor.cells[i - 1].corridor) continue;
    ++rooms;
    alike += (layout.floor.cells[i].size() - layout.floor.cells[i - 1].size()).norm() < 1e-6 ? 1U : 0U;
  }
  EXPECT_GT(rooms, 5U);
  EXPECT_GT(alike, rooms / 2);
}

}  // namespace
}  // namespace isthmus
