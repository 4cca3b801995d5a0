#include "tools/simulate/plan/floor_plan.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace isthmus {
namespace {

Building thin_room() {
  Building building;
  building.wall_thickness_m = 0;
  building.walls.push_back({{{0, 0}, {10, 0}, {10, 5}, {0, 5}}, true, {}});
  return building;
}

double length_m(const FloorPlan& plan) {
  double length = 0;
  for (const Segment& segment : plan.segments) length += (segment.b - segment.a).norm();
  return length;
}

TEST(FloorPlan, ClosedThinWallIsItsEdges) {
  const FloorPlan plan = build_floor_plan(thin_room());
  EXPECT_EQ(plan.segments.size(), 4U);
  EXPECT_DOUBLE_EQ(length_m(plan), 30);
  EXPECT_EQ(plan.low, Eigen::Vector2d(0, 0));
  EXPECT_EQ(plan.high, Eigen::Vector2d(10, 5));
}

TEST(FloorPlan, DoorsAreGapsAtTheirDistanceAlongTheWall) {
  Building building = thin_room();
  building.walls[0].doors = {{12, 1}, {3, 2}};  // on the eastern wall, and on the southern
  const FloorPlan plan = build_floor_plan(building);
  EXPECT_DOUBLE_EQ(length_m(plan), 27);
  EXPECT_NEAR(clearance_m(plan, {3, -0.5}, {3, 0.5}), 1.0, 1e-12);
  EXPECT_NEAR(clearance_m(plan, {9.5, 2}, {10.5, 2}), 0.5, 1e-12);
  EXPECT_EQ(clearance_m(plan, {5, -0.5}, {5, 0.5}), 0);
}

TEST(FloorPlan, DoorMayTakeInACorner) {
  Building building = thin_room();
  building.walls[0].doors = {{10, 2}};
  const FloorPlan plan = build_floor_plan(building);
  EXPECT_DOUBLE_EQ(length_m(plan), 28);
  EXPECT_NEAR(clearance_m(plan, {10, 0}, {10, 0}), 1.0, 1e-12);
}

TEST(FloorPlan, ThickWallHasTwoSides) {
  Building building = thin_room();
  building.wall_thickness_m = 0.2;
  const FloorPlan plan = build_floor_plan(building);
  EXPECT_NEAR(clearance_m(plan, {5, 2.5}, {5, 2.5}), 2.4, 1e-12);
  EXPECT_NEAR(clearance_m(plan, {5, -1}, {5, -1}), 0.9, 1e-12);
  EXPECT_EQ(plan.low, Eigen::Vector2d(-0.1, -0.1));
}

TEST(FloorPlan, RoughWallStaysNearTheStraightOne) {
  Building building = thin_room();
  building.roughness_m = 0.01;
  const FloorPlan plan = build_floor_plan(building);
  EXPECT_GT(plan.segments.size(), 40U);
  double farthest = 0;
  for (const Segment& segment : plan.segments) {
    const double off = std::min({std::abs(segment.b.x()), std::abs(segment.b.x() - 10),
                                 std::abs(segment.b.y()), std::abs(segment.b.y() - 5)});
    farthest = std::max(farthest, off);
  }
  EXPECT_GT(farthest, 0.005);
  EXPECT_LT(farthest, 0.06);
}

TEST(FloorPlan, GlossComesToItsShareOfWalls) {
  Building building;
  building.wall_thickness_m = 0;
  building.glossy_share = 0.25;
  for (int i = 0; i < 2000; ++i) building.walls.push_back({{{0, 1.0 * i}, {1, 1.0 * i}}, false, {}});
  int glossy = 0;
  for (const Segment& segment : build_floor_plan(building).segments)
    glossy += segment.return_limit_rad < 2 ? 1 : 0;
  EXPECT_NEAR(glossy, 500, 80);
}

TEST(FloorPlan, EmptyBuildingIsClearEverywhere) {
  EXPECT_EQ(clearance_m(build_floor_plan({}), {0, 0}, {1, 1}), std::numeric_limits<double>::infinity());
}

TEST(FloorPlan, SegmentsThatCrossAreAtNoDistance) {
  EXPECT_EQ(distance_m(Segment{{0, 0}, {2, 2}}, Segment{{0, 2}, {2, 0}}), 0);
  EXPECT_NEAR(distance_m(Segment{{0, 0}, {2, 0}}, Segment{{3, -1}, {3, 1}}), 1, 1e-12);
  EXPECT_NEAR(distance_m(Segment{{0, 0}, {2, 0}}, Segment{{0, 1}, {2, 1}}), 1, 1e-12);
}

}  // namespace
}  // namespace isthmus
