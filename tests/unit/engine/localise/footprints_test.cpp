#include "server/engine/localise/footprints.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/solids.hpp"

namespace isthmus {
namespace {

constexpr double radius_m = 0.3;

// A robot without a laser, told of its odometry.
class Blind {
 public:
  Blind() {
    robot.declaration.robot = "R1";
    robot.declaration.laser.range_max_m = 0;
    robot.declaration.footprint_radius_m = radius_m;
    robot.declared = true;
  }
  std::optional<ScanOutcome> tell(const Pose& odom_from_robot, std::int64_t utime) {
    return take_odometry(map, robot, odom_from_robot, utime, options);
  }
  // Along x at 1 m/s, told at 20 Hz, from metre `from` to metre `to`.
  int drive(int from, int to) {
    int answers = 0;
    for (int i = 20 * from; i <= 20 * to; ++i) answers += tell({0.05 * i, 0, 0}, i * 50'000) ? 1 : 0;
    return answers;
  }

  Map map;
  Robot robot;
  EngineOptions options;
};

TEST(Footprints, AMaximumRangeOfZeroIsNoLaser) {
  Blind blind;
  EXPECT_TRUE(has_no_laser(blind.robot));
  blind.robot.declaration.laser.range_max_m = 8;
  EXPECT_FALSE(has_no_laser(blind.robot));
}

TEST(Footprints, ARobotIsPlacedTenTimesASecond) {
  Blind blind;
  EXPECT_EQ(blind.drive(0, 3), 31);  // of 61
  EXPECT_NEAR(blind.map.manifold().project(blind.robot.place->pose).x, 3, 1e-9);
}

TEST(Footprints, PatchesFollowTheWayAndAreRelatedByOdometryAlone) {
  Blind blind;
  blind.drive(0, 10);
  const auto patches = static_cast<int>(blind.map.manifold().size());
  EXPECT_GE(patches, 9);
  EXPECT_LE(patches, 11);
  EXPECT_EQ(static_cast<int>(blind.map.graph().relations().size()), patches - 1);
  for (const auto& [id, relation] : blind.map.graph().relations()) {
    EXPECT_EQ(relation.origin.kind, OriginKind::odometry);
    EXPECT_EQ(relation.b.value, relation.a.value + 1);
  }
  for (int i = 0; i < patches; ++i) {
    EXPECT_TRUE(blind.map.manifold().patch(PatchId{i}).points.empty());
    EXPECT_EQ(blind.map.manifold().patch(PatchId{i}).robot, "R1");
  }
}

TEST(Footprints, TurningOnTheSpotMakesPatchesToo) {
  Blind blind;
  for (int i = 0; i <= 100; ++i) blind.tell({0, 0, 0.02 * i}, i * 100'000);
  EXPECT_GE(blind.map.manifold().size(), 3U);
  EXPECT_LE(blind.map.manifold().size(), 4U);
}

TEST(Footprints, StandingMakesNothing) {
  Blind blind;
  for (int i = 0; i <= 1000; ++i) blind.tell({2, 1, 0.4}, i * 100'000);
  EXPECT_EQ(blind.map.manifold().size(), 1U);
}

TEST(Footprints, FreeIsWhatTheFootprintSwept) {
  // A bend: 2 m straight, then 2 m to the left.
  std::vector<Pose> way;
  for (int i = 0; i <= 10; ++i) way.push_back({0.2 * i - 2, -2, 0});
  for (int i = 1; i <= 10; ++i) way.push_back({0, 0.2 * i - 2, 0.5 * std::numbers::pi});
  const PatchPtr patch = make_swept_patch(PatchId{4}, "R1", 77, radius_m, way, {});
  const double disc_m2 = std::numbers::pi * radius_m * radius_m;
  // Two strips and a disc's two halves, and the corner counted once: the square overlap is there in both.
  const double swept_m2 = 2 * 2 * (2 * radius_m) + disc_m2 - radius_m * radius_m * (1 - std::numbers::pi / 4);
  EXPECT_NEAR(testing::area_m2(patch->free_space), swept_m2, 0.06 * swept_m2);
  EXPECT_TRUE(contains(patch->free_space, {0, 0}));
  EXPECT_TRUE(contains(patch->free_space, {-1.9, -2.25}));
  EXPECT_TRUE(contains(patch->free_space, {0.25, -1}));
  EXPECT_FALSE(contains(patch->free_space, {0.35, -1}));
  EXPECT_FALSE(contains(patch->free_space, {-1, -1}));
  EXPECT_EQ(patch->id, PatchId{4});
  EXPECT_EQ(patch->utime, 77);
}

TEST(Footprints, PatchesOfADriveCoverItsWholeWay) {
  Blind blind;
  blind.drive(0, 6);
  const double end =
      blind.map.manifold().pose(PatchId{static_cast<std::int32_t>(blind.map.manifold().size()) - 1}).x;
  std::vector<Polysolid> parts;
  for (std::size_t i = 0; i < blind.map.manifold().size(); ++i) {
    const PatchId id{static_cast<std::int32_t>(i)};
    parts.push_back(transformed(blind.map.manifold().pose(id), blind.map.manifold().patch(id).free_space));
  }
  const Polysolid all = testing::united(parts);
  EXPECT_EQ(all.polygons().size(), 1U);
  EXPECT_NEAR(testing::area_m2(all), end * 2 * radius_m + std::numbers::pi * radius_m * radius_m, 0.1);
  for (double x = 0; x < end; x += 0.1) EXPECT_TRUE(contains(all, {x, 0.2})) << x;
}

TEST(Footprints, ARadiusOfNothingStillSweepsSomething) {
  const PatchPtr patch = make_swept_patch(PatchId{0}, "R1", 0, 0, {{-1, 0, 0}, {}}, {});
  EXPECT_GT(testing::area_m2(patch->free_space), 0.1);
}

TEST(Footprints, AJumpBeginsANewIsland) {
  Blind blind;
  blind.drive(0, 3);
  const std::size_t before = blind.map.manifold().size();
  const auto jumped = blind.tell({50, 20, 1}, 3'100'000);
  ASSERT_TRUE(jumped);
  EXPECT_TRUE(jumped->new_session);
  EXPECT_EQ(blind.map.manifold().size(), before + 1);
  const PatchId newest{static_cast<std::int32_t>(before)};
  EXPECT_TRUE(blind.map.graph().neighbours(newest).empty());
  EXPECT_EQ(blind.map.graph().islands().size(), 2U);
  EXPECT_EQ(blind.map.manifold().pose(newest), Pose{});
  // And it goes on from there.
  for (int i = 1; i <= 15; ++i) blind.tell({50 + 0.1 * i, 20, 1}, 3'100'000 + i * 100'000);
  EXPECT_EQ(blind.map.graph().islands().size(), 2U);
  EXPECT_GT(blind.map.manifold().size(), before + 1);
}

}  // namespace
}  // namespace isthmus
