#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

#include "tools/simulate/run/ray_caster.hpp"
#include "tools/simulate/run/unicycle.hpp"
#include "tools/simulate/wild/bend.hpp"
#include "tools/simulate/wild/layout.hpp"
#include "tools/simulate/wild/site.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

std::uint64_t a_seed() { return *rc::gen::inRange<std::uint64_t>(0, 1'000'000); }

TEST(WildProperty, NobodyDrivesIntoAWallOrAPieceOfFurnitureWheneverItComes) {
  EXPECT_TRUE(rc::check([] {
    const std::uint64_t seed = a_seed();
    const Scenario scenario = make_wild_scenario(draw_wild(seed));
    std::vector<RayCaster> casters{RayCaster(scenario.plan)};
    for (const BuildingChange& change : scenario.changes) casters.emplace_back(change.plan);
    for (const RobotPlan& robot : scenario.robots) {
      const TruePath path = drive(robot, seed);
      for (const Pose& pose : path.stretches().at(0).world_from_robot)
        for (const RayCaster& caster : casters) RC_ASSERT(!caster.touches({pose.x, pose.y}, robot.radius_m));
    }
  }));
}

// At the end of its last lap each robot has been there before, a long way ago.
TEST(WildProperty, EveryTourOfARobotClosesALoop) {
  EXPECT_TRUE(rc::check([] {
    const WildDraw draw = draw_wild(a_seed());
    const Scenario scenario = make_wild_scenario(draw);
    for (std::size_t i = 0; i < draw.robots.size(); ++i) {
      const auto poses = drive(scenario.robots[i], draw.seed).stretches().at(0).world_from_robot;
      double driven_m = 0, closed_m = 0;
      std::size_t from = poses.size();
      while (from-- > 1 && driven_m < 40)
        driven_m += (position(poses[from]) - position(poses[from - 1])).norm();
      for (std::size_t k = 0; k < from; k += 5)
        if ((position(poses[k]) - position(poses.back())).norm() < 1.5)
          closed_m = std::max(closed_m, static_cast<double>(from - k));
      RC_ASSERT(closed_m > 0);
    }
  }));
}

TEST(WildProperty, CellsTileTheRectangle) {
  EXPECT_TRUE(rc::check([] {
    const WildDraw draw = draw_wild(a_seed());
    const FloorLayout layout = lay_out_wild(draw.building, draw.seed).floor;
    double area = 0;
    for (const FloorCell& cell : layout.cells) {
      RC_ASSERT(cell.size().minCoeff() > 0.05);
      area += cell.size().prod();
    }
    RC_ASSERT(std::abs(area - layout.size.prod()) < 0.01 * layout.size.prod());
  }));
}

// What a straight wall is before it is bent keeps its length across the building, and loses a quarter along
// it at most.
TEST(WildProperty, ABendKeepsDistances) {
  EXPECT_TRUE(rc::check([] {
    const WildDraw draw = draw_wild(a_seed());
    const Vector2d size = lay_out_wild(draw.building, draw.seed).floor.size;
    const Bend bend(draw.building, size, draw.seed);
    const double x = 0.01 * *rc::gen::inRange(0, 100) * size.x(),
                 y = 0.01 * *rc::gen::inRange(0, 101) * size.y();
    const Vector2d middle = bend({x, y});
    RC_ASSERT(std::abs((bend({x, y + 0.1}) - middle).norm() - 0.1) < 1e-9);
    const double along = (bend({x + 0.01, y}) - middle).norm() / 0.01;
    RC_ASSERT(along > 0.74);
    RC_ASSERT(along < 1.26);
  }));
}

}  // namespace
}  // namespace isthmus
