#include <Eigen/LU>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>

#include "tools/simulate/run/ray_caster.hpp"
#include "tools/simulate/run/simulation.hpp"
#include "tools/simulate/run/unicycle.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr double infinity = std::numeric_limits<double>::infinity();

double a_number(double low, double high) {
  return low + (high - low) * static_cast<double>(*rc::gen::inRange(0, 1'000'001)) * 1e-6;
}

FloorPlan a_plan() {
  FloorPlan plan;
  const int count = *rc::gen::inRange(1, 60);
  plan.low = plan.high = Vector2d(a_number(-9, 9), a_number(-9, 9));
  for (int i = 0; i < count; ++i) {
    const Vector2d a(a_number(-20, 20), a_number(-15, 15));
    const bool upright = *rc::gen::inRange(0, 4) == 0;  // axis-parallel walls lie on the borders of cells
    const Vector2d b = upright ? Vector2d(a.x(), a_number(-15, 15))
                               : Vector2d(a + Vector2d(a_number(-6, 6), a_number(-6, 6)));
    plan.segments.push_back({a, b});
    plan.low = plan.low.cwiseMin(a).cwiseMin(b);
    plan.high = plan.high.cwiseMax(a).cwiseMax(b);
  }
  return plan;
}

double range_by_brute_force(const FloorPlan& plan, const Vector2d& from, const Vector2d& direction) {
  double nearest = infinity;
  for (const Segment& segment : plan.segments) {
    Eigen::Matrix2d system;
    system << direction, segment.a - segment.b;
    if (std::abs(system.determinant()) < 1e-12) continue;
    const Vector2d solution = system.inverse() * (segment.a - from);
    if (solution[0] >= 0 && solution[1] >= 0 && solution[1] <= 1) nearest = std::min(nearest, solution[0]);
  }
  return nearest;
}

TEST(RayCasterProperty, AgreesWithBruteForce) {
  EXPECT_TRUE(rc::check([] {
    const FloorPlan plan = a_plan();
    const RayCaster caster(plan, a_number(0.2, 5));
    for (int i = 0; i < 50; ++i) {
      const Vector2d from(a_number(-25, 25), a_number(-20, 20));
      const double yaw = a_number(-3.2, 3.2), reach = a_number(1, 60);
      const Vector2d direction(std::cos(yaw), std::sin(yaw));
      const auto hit = caster.cast(from, direction, reach);
      const double expected = range_by_brute_force(plan, from, direction);
      if (hit) {
        RC_ASSERT(std::abs(hit->range_m - expected) < 1e-6);
      } else {
        RC_ASSERT(expected > reach - 1e-6);
      }
    }
  }));
}

TEST(RayCasterProperty, SightIsMutualAndAgreesWithBruteForce) {
  EXPECT_TRUE(rc::check([] {
    const FloorPlan plan = a_plan();
    const RayCaster caster(plan);
    for (int i = 0; i < 50; ++i) {
      const Vector2d a(a_number(-20, 20), a_number(-15, 15)), b(a_number(-20, 20), a_number(-15, 15));
      const double distance = (b - a).norm();
      const bool seen = caster.line_of_sight(a, b);
      RC_ASSERT(seen == caster.line_of_sight(b, a));
      const double range = range_by_brute_force(plan, a, (b - a) / distance);
      if (std::abs(range - distance) > 1e-6) RC_ASSERT(seen == (range > distance));
    }
  }));
}

TEST(RayCasterProperty, TouchesWhatIsNear) {
  EXPECT_TRUE(rc::check([] {
    const FloorPlan plan = a_plan();
    const RayCaster caster(plan);
    const Vector2d point(a_number(-22, 22), a_number(-17, 17));
    const double radius = a_number(0.05, 3), distance = clearance_m(plan, point, point);
    if (std::abs(distance - radius) > 1e-9) RC_ASSERT(caster.touches(point, radius) == (distance < radius));
  }));
}

TEST(RobotsProperty, NeverCrossAWallWhateverTheSeed) {
  const std::vector<ScenarioSummary> scenarios = list_scenarios();
  EXPECT_TRUE(rc::check([&] {
    const std::string name = scenarios[*rc::gen::inRange<std::size_t>(0, scenarios.size())].name;
    const Scenario scenario = load_scenario(name);
    const RayCaster caster(scenario.plan);
    const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1'000'000);
    for (const RobotPlan& robot : scenario.robots) {
      const TruePath path = drive(robot, seed);
      for (const PathStretch& stretch : path.stretches()) {
        const auto& poses = stretch.world_from_robot;
        for (std::size_t i = 1; i < poses.size(); ++i) {
          RC_ASSERT(caster.line_of_sight({poses[i - 1].x, poses[i - 1].y}, {poses[i].x, poses[i].y}));
          RC_ASSERT(!caster.touches({poses[i].x, poses[i].y}, robot.radius_m));
        }
      }
    }
  }));
}

bool same(const SimulatedRun& a, const SimulatedRun& b) {
  if (a.events.size() != b.events.size()) return false;
  for (std::size_t i = 0; i < a.events.size(); ++i) {
    if (a.events[i].receive_utime != b.events[i].receive_utime) return false;
    const auto* scan = std::get_if<ScanEvent>(&a.events[i].body);
    const auto* odometry = std::get_if<OdometryEvent>(&a.events[i].body);
    if (a.events[i].body.index() != b.events[i].body.index()) return false;
    if (scan != nullptr && scan->scan.ranges_m != std::get<ScanEvent>(b.events[i].body).scan.ranges_m)
      return false;
    if (odometry != nullptr &&
        odometry->odom_from_robot != std::get<OdometryEvent>(b.events[i].body).odom_from_robot) {
      return false;
    }
  }
  return true;
}

TEST(SimulationProperty, SameSeedGivesTheSameRun) {
  const Scenario scenario = load_scenario("hard", {"duration_s=3"});
  EXPECT_TRUE(rc::check([&] {
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    RC_ASSERT(same(simulate(scenario, seed), simulate(load_scenario("hard", {"duration_s=3"}), seed)));
    RC_ASSERT(!same(simulate(scenario, seed), simulate(scenario, seed + 1)));
  }));
}

TEST(SimulationProperty, NoSightingGoesThroughAWall) {
  const Scenario scenario = load_scenario("office", {"duration_s=60", "laser.rate_hz=0"});
  const RayCaster caster(scenario.plan);
  EXPECT_TRUE(rc::check([&] {
    const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1'000'000);
    std::vector<TruePath> paths;
    for (const RobotPlan& robot : scenario.robots) paths.push_back(drive(robot, seed));
    for (const Event& event : simulate(scenario, seed).events) {
      const auto* sighting = std::get_if<SightingEvent>(&event.body);
      if (sighting == nullptr) continue;
      const double time_s = static_cast<double>(sighting->utime - scenario.start_utime) * 1e-6;
      const auto robot_index = static_cast<std::size_t>(sighting->robot[1] - '1');
      const auto observer = paths[robot_index].at(time_s);
      const auto target = paths[static_cast<std::size_t>(sighting->barcode - 101)].at(time_s);
      RC_ASSERT(observer && target);
      RC_ASSERT(caster.line_of_sight({observer->x, observer->y}, {target->x, target->y}));
      RC_ASSERT(std::abs(sighting->range_m - std::hypot(target->x - observer->x, target->y - observer->y)) <
                0.15);
    }
  }));
}

}  // namespace
}  // namespace isthmus
