#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/simulate/plan/floor_layout.hpp"
#include "tools/simulate/run/ray_caster.hpp"
#include "tools/simulate/run/traffic.hpp"
#include "tools/simulate/run/unicycle.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

FloorStyle a_style() {
  FloorStyle style;
  style.seed = *rc::gen::inRange<std::uint64_t>(0, 1'000'000);
  style.area_m2 = *rc::gen::inRange(100, 4000);
  style.corridors = *rc::gen::element(Corridors::any, Corridors::spine);
  return style;
}

std::vector<std::string> settings_of(const FloorStyle& style, int robots) {
  return {"floor.seed=" + std::to_string(style.seed), "floor.area_m2=" + std::to_string(style.area_m2),
          "floor.corridors=" + std::string(word(style.corridors)), "floor.robots=" + std::to_string(robots)};
}

TEST(FloorProperty, EveryTourIsDrivableWhateverTheFloorAndTheSeed) {
  EXPECT_TRUE(rc::check([] {
    const int robots = *rc::gen::inRange(1, 6);
    const Scenario scenario = load_scenario("floor", settings_of(a_style(), robots));
    RC_ASSERT(scenario.robots.size() == static_cast<std::size_t>(robots));
    const RayCaster caster(scenario.plan);
    const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1'000'000);
    for (const RobotPlan& robot : scenario.robots) {
      const TruePath path = drive(robot, seed);
      RC_ASSERT(path.end_s() > 60);
      for (const Pose& pose : path.stretches().at(0).world_from_robot)
        RC_ASSERT(!caster.touches({pose.x, pose.y}, robot.radius_m));
    }
  }));
}

TEST(FloorProperty, RobotsMeetAtTheLatestAtTheEnd) {
  EXPECT_TRUE(rc::check([] {
    const int robots = *rc::gen::inRange(2, 5);
    FloorStyle style = a_style();
    style.area_m2 = std::max(style.area_m2, 200.0);
    const Scenario scenario = load_scenario("floor", settings_of(style, robots));
    const RayCaster caster(scenario.plan);
    std::vector<Vector2d> ends;
    for (const RobotPlan& robot : scenario.robots) {
      const Pose end = drive(robot, 1).stretches().at(0).world_from_robot.back();
      for (const Vector2d& other : ends) {
        RC_ASSERT(caster.line_of_sight({end.x, end.y}, other));
        RC_ASSERT((Vector2d(end.x, end.y) - other).norm() > 2 * robot.radius_m);
        RC_ASSERT((Vector2d(end.x, end.y) - other).norm() < 4);
      }
      ends.emplace_back(end.x, end.y);
    }
  }));
}

double min_distance_m(const std::vector<TruePath>& paths) {
  double end_s = 0, least = 1e9;
  for (const TruePath& path : paths) end_s = std::max(end_s, path.end_s());
  for (double time_s = 0; time_s < end_s; time_s += 0.1) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const Pose a = *paths[i].at(time_s);
      for (std::size_t k = 0; k < i; ++k) {
        const Pose b = *paths[k].at(time_s);
        least = std::min(least, std::hypot(a.x - b.x, a.y - b.y));
      }
    }
  }
  return least;
}

struct Traffic {
  std::vector<TruePath> alone;
  std::vector<TruePath> together;
};

Traffic traffic_on(const FloorStyle& style, int robots) {
  const Scenario scenario = load_scenario("floor", settings_of(style, robots));
  Traffic traffic;
  std::vector<double> radii_m;
  for (const RobotPlan& robot : scenario.robots) {
    traffic.alone.push_back(drive(robot, 1));
    radii_m.push_back(robot.radius_m);
  }
  traffic.together = traffic.alone;
  give_way(traffic.together, radii_m);
  return traffic;
}

TEST(FloorProperty, RobotsThatGiveWayKeepTheirWays) {
  EXPECT_TRUE(rc::check([] {
    const auto [alone, together] = traffic_on(a_style(), *rc::gen::inRange(2, 6));
    for (std::size_t i = 0; i < together.size(); ++i) {
      RC_ASSERT(together[i].end_s() >= alone[i].end_s() - 1e-6);
      RC_ASSERT(*together[i].at(1e6) == *alone[i].at(1e6));
      const auto& poses = together[i].stretches().at(0).world_from_robot;
      for (std::size_t k = 1; k < poses.size(); ++k)
        RC_ASSERT(std::hypot(poses[k].x - poses[k - 1].x, poses[k].y - poses[k - 1].y) < 0.0101);
    }
  }));
}

// Where one parks in another's way for good there is no way out; that is rare.
TEST(FloorProperty, RobotsThatGiveWayDoNotTouch) {
  FloorStyle style;
  int touching_alone = 0, touching = 0;
  for (style.seed = 1; style.seed <= 40; ++style.seed) {
    const auto [alone, together] = traffic_on(style, 4);
    touching_alone += min_distance_m(alone) < 0.44 ? 1 : 0;
    touching += min_distance_m(together) < 0.44 ? 1 : 0;
  }
  EXPECT_GT(touching_alone, 20);
  EXPECT_LE(touching, 2);
}

TEST(FloorProperty, CellsTileTheFloor) {
  EXPECT_TRUE(rc::check([] {
    const FloorStyle style = a_style();
    const FloorLayout layout = lay_out_floor(style);
    RC_ASSERT(std::abs(layout.size.prod() - style.area_m2) < 1e-6);
    double area = 0;
    for (const FloorCell& cell : layout.cells) {
      RC_ASSERT(cell.size().minCoeff() > 1.5);
      area += cell.size().prod();
      for (const FloorCell& other : layout.cells) {
        const Vector2d common = cell.high.cwiseMin(other.high) - cell.low.cwiseMax(other.low);
        RC_ASSERT(&cell == &other || common.minCoeff() < 1e-9);
      }
    }
    RC_ASSERT(std::abs(area - style.area_m2) < 1e-6);
  }));
}

TEST(FloorProperty, CorridorsHangTogetherAndDoorsLeadToEveryRoomThatTheyFit) {
  EXPECT_TRUE(rc::check([] {
    const FloorLayout layout = lay_out_floor(a_style());
    std::vector<bool> reached(layout.cells.size(), false);
    for (std::size_t i = 0; i < layout.cells.size() && !reached[i]; ++i)
      reached[i] = layout.cells[i].corridor;
    const auto spread = [&](const FloorBorder& border) {
      const bool news = reached[border.a] != reached[border.b];
      reached[border.a] = reached[border.b] = reached[border.a] || reached[border.b];
      return news;
    };
    for (bool any = true; any;) {
      any = false;
      for (const FloorBorder& border : layout.borders) {
        const bool open = layout.cells[border.a].corridor && layout.cells[border.b].corridor;
        any = (open && spread(border)) || any;
      }
    }
    for (std::size_t i = 0; i < layout.cells.size(); ++i) RC_ASSERT(reached[i] == layout.cells[i].corridor);
    for (bool any = true; any;) {
      any = false;
      for (const FloorDoor& door : layout.doors) any = spread(layout.borders[door.border]) || any;
    }
    RC_ASSERT(std::ranges::count(reached, false) * 50 <= static_cast<std::ptrdiff_t>(reached.size()));
    for (const FloorDoor& door : layout.doors) {
      const FloorBorder& border = layout.borders[door.border];
      RC_ASSERT(door.along - 0.5 * door.width_m > border.from);
      RC_ASSERT(door.along + 0.5 * door.width_m < border.to);
    }
  }));
}

TEST(FloorProperty, SeedsGiveDifferentBuildings) {
  EXPECT_TRUE(rc::check([] {
    FloorStyle style = a_style();
    const FloorLayout one = lay_out_floor(style), same = lay_out_floor(style);
    ++style.seed;
    const FloorLayout other = lay_out_floor(style);
    RC_ASSERT(one.cells.size() == same.cells.size());
    RC_ASSERT(one.doors.size() == same.doors.size());
    std::size_t shared = 0;
    for (const FloorCell& cell : one.cells) {
      shared += static_cast<std::size_t>(std::ranges::count_if(other.cells, [&](const FloorCell& candidate) {
        return (candidate.low - cell.low).norm() < 0.1 && (candidate.high - cell.high).norm() < 0.1;
      }));
    }
    RC_ASSERT(shared <= 1 + one.cells.size() / 10);
  }));
}

}  // namespace
}  // namespace isthmus
