#include "tools/simulate/run/ray_caster.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

FloorPlan room() {
  Building building;
  building.wall_thickness_m = 0;
  building.walls.push_back({{{0, 0}, {10, 0}, {10, 5}, {0, 5}}, true, {{5, 1}}});
  building.walls.push_back({{{6, 0}, {6, 3}}, false, {}});
  return build_floor_plan(building);
}

TEST(RayCaster, HitsTheNearestSurface) {
  const RayCaster caster(room());
  EXPECT_NEAR(caster.cast({1, 1}, {1, 0}, 100)->range_m, 5, 1e-9);
  EXPECT_NEAR(caster.cast({1, 4}, {1, 0}, 100)->range_m, 9, 1e-9);
  EXPECT_NEAR(caster.cast({1, 1}, {-1, 0}, 100)->range_m, 1, 1e-9);
}

TEST(RayCaster, MeasuresIncidenceFromTheNormal) {
  const RayCaster caster(room());
  const double diagonal = std::sqrt(0.5);
  EXPECT_NEAR(caster.cast({1, 1}, {1, 0}, 100)->incidence_rad, 0, 1e-9);
  EXPECT_NEAR(caster.cast({1, 4}, {diagonal, diagonal}, 100)->incidence_rad, std::numbers::pi / 4, 1e-9);
}

TEST(RayCaster, SeesNothingBeyondItsReachOrThroughADoor) {
  const RayCaster caster(room());
  EXPECT_FALSE(caster.cast({1, 4}, {1, 0}, 8.9));
  EXPECT_FALSE(caster.cast({5, 2}, {0, -1}, 1000));
}

TEST(RayCaster, CastsFromOutsideTheGrid) {
  const RayCaster caster(room());
  EXPECT_NEAR(caster.cast({-20, 4}, {1, 0}, 100)->range_m, 20, 1e-9);
  EXPECT_FALSE(caster.cast({-20, 4}, {-1, 0}, 100));
  EXPECT_FALSE(caster.cast({-20, 8}, {1, 0}, 100));
}

TEST(RayCaster, NoRaySlipsThroughACorner) {
  const RayCaster caster(room());
  const Eigen::Vector2d from(3, 2);
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0, 0), Eigen::Vector2d(0, 5)}) {
    const Eigen::Vector2d direction = (corner - from).normalized();
    ASSERT_TRUE(caster.cast(from, direction, 100));
    EXPECT_NEAR(caster.cast(from, direction, 100)->range_m, (corner - from).norm(), 1e-6);
  }
}

TEST(RayCaster, WallsBlockSight) {
  const RayCaster caster(room());
  EXPECT_FALSE(caster.line_of_sight({5, 1}, {7, 1}));
  EXPECT_TRUE(caster.line_of_sight({5, 4}, {7, 4}));
  EXPECT_TRUE(caster.line_of_sight({5, 4}, {5, 4}));
}

TEST(RayCaster, KnowsWhatADiscTouches) {
  const RayCaster caster(room());
  EXPECT_TRUE(caster.touches({6.2, 1}, 0.25));
  EXPECT_FALSE(caster.touches({6.3, 1}, 0.25));
  EXPECT_FALSE(caster.touches({50, 50}, 1));
}

TEST(RayCaster, EmptyPlanHasNothingToHit) {
  const RayCaster caster(FloorPlan{});
  EXPECT_FALSE(caster.cast({0, 0}, {1, 0}, 100));
  EXPECT_TRUE(caster.line_of_sight({0, 0}, {9, 9}));
  EXPECT_FALSE(caster.touches({0, 0}, 1));
}

}  // namespace
}  // namespace isthmus
