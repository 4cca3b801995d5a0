#include <gtest/gtest.h>

#include <limits>

#include "patches/polysolid.hpp"
#include "tests/support/patch_scenes.hpp"
#include "tests/support/solids.hpp"

namespace isthmus {
namespace {

using testing::area_m2;
using testing::full_turn;
using testing::half_turn;
using testing::infinite_range;
using testing::look_at;
using testing::nan_range;
using testing::reversed;
using testing::shared_area_m2;

FreeSpaceOptions exact() {
  FreeSpaceOptions options;
  options.outline.simplify_tolerance_m = 0;
  return options;
}

// The area of the wedges between n + 1 beams of one range.
double fan_area_m2(double wedges, double range_m, double step_rad) {
  return wedges * 0.5 * range_m * range_m * std::sin(step_rad);
}

TEST(FreeSpace, HalfTurnIncludesTheLaser) {
  const Scan scan = half_turn(181, 5);
  Laser laser;
  laser.robot_from_laser = {0.3, 0.1, 0};
  const Polysolid free = free_space_of(scan, laser, exact());
  ASSERT_EQ(free.polygons().size(), 1U);
  EXPECT_NEAR(area_m2(free), fan_area_m2(180, 5, scan.bearing_step_rad), 1e-4);
  EXPECT_EQ(free.polygons()[0].outer.front(), Eigen::Vector2d(0.3, 0.1));
  EXPECT_TRUE(contains(free, {0.31, 0.1}));
  EXPECT_TRUE(contains(free, {5.29, 0.1}));
  EXPECT_FALSE(contains(free, {0.29, 0.1}));
}

TEST(FreeSpace, FullTurnIsOneRingWithoutTheLaser) {
  const Scan scan = full_turn(360, 5);
  const Polysolid free = free_space_of(scan, {}, exact());
  ASSERT_EQ(free.polygons().size(), 1U);
  EXPECT_EQ(free.polygons()[0].outer.size(), 360U);
  EXPECT_NEAR(area_m2(free), fan_area_m2(360, 5, scan.bearing_step_rad), 1e-4);
}

TEST(FreeSpace, MoreThanAFullTurnCountsOnce) {
  Scan scan = full_turn(360, 5);
  scan.ranges_m.resize(1000, 5);
  EXPECT_NEAR(area_m2(free_space_of(scan, {}, exact())), fan_area_m2(360, 5, scan.bearing_step_rad), 1e-4);
}

TEST(FreeSpace, NegativeStepIsTheSameFreeSpace) {
  Scan scan = half_turn(181, 5);
  look_at(scan, {{0, 3}, {1.2, 2}, {-1.4, 4}});
  const Polysolid free = free_space_of(scan, {}, exact());
  const Polysolid other = free_space_of(reversed(scan), {}, exact());
  EXPECT_GT(area_m2(free), 5);
  EXPECT_NEAR(area_m2(other), area_m2(free), 1e-4);
  EXPECT_NEAR(shared_area_m2(free, other), area_m2(free), 1e-4);
}

TEST(FreeSpace, IgnoredBeamClosesItsWedgesToTheLaser) {
  for (const float ignored : {nan_range, 0.0F, -1.0F, -infinite_range, 0.01F}) {
    Scan scan = half_turn(181, 5);
    scan.ranges_m[100] = ignored;
    const Polysolid free = free_space_of(scan, {}, exact());
    EXPECT_EQ(free.polygons().size(), 2U);
    EXPECT_NEAR(area_m2(free), fan_area_m2(178, 5, scan.bearing_step_rad), 1e-4) << ignored;
    const double bearing = testing::bearing_rad(scan, 100);
    EXPECT_FALSE(contains(free, {std::cos(bearing), std::sin(bearing)}));
  }
}

TEST(FreeSpace, GapInAFullTurnMayLieAcrossItsFirstBeam) {
  Scan scan = full_turn(360, 5);
  scan.ranges_m[0] = scan.ranges_m[359] = nan_range;
  const Polysolid free = free_space_of(scan, {}, exact());
  ASSERT_EQ(free.polygons().size(), 1U);
  EXPECT_NEAR(area_m2(free), fan_area_m2(357, 5, scan.bearing_step_rad), 1e-4);
  Scan middle = full_turn(360, 5);
  middle.ranges_m[200] = nan_range;
  EXPECT_EQ(free_space_of(middle, {}, exact()).polygons().size(), 1U) << "beam 359 and beam 0 are neighbours";
}

TEST(FreeSpace, NoReturnOpensOnlyAsFarAsAllowed) {
  Scan scan = half_turn(181, infinite_range);
  EXPECT_TRUE(free_space_of(scan, {}, exact()).empty());
  FreeSpaceOptions options = exact();
  options.no_return_range_m = 2;
  EXPECT_NEAR(area_m2(free_space_of(scan, {}, options)), fan_area_m2(180, 2, scan.bearing_step_rad), 1e-4);
  scan.ranges_m.assign(181, 80.0F);
  EXPECT_NEAR(area_m2(free_space_of(scan, {}, options)), fan_area_m2(180, 2, scan.bearing_step_rad), 1e-4);
}

TEST(FreeSpace, BeamsAreCutAtTheMaximum) {
  const Scan scan = half_turn(181, 50);
  EXPECT_NEAR(area_m2(free_space_of(scan, {}, exact())), fan_area_m2(180, 20, scan.bearing_step_rad), 1e-3);
}

TEST(FreeSpace, SimplifyingRoomLeavesFewVerticesAndItsArea) {
  Scan scan = full_turn(1081, 0);
  look_at(scan, {{0, 4}, {std::numbers::pi / 2, 3}, {std::numbers::pi, 5}, {-std::numbers::pi / 2, 2}});
  const Polysolid free = free_space_of(scan, {}, {});
  ASSERT_EQ(free.polygons().size(), 1U);
  EXPECT_LT(free.polygons()[0].outer.size(), 14U);
  EXPECT_NEAR(area_m2(free), 45, 0.45);
}

TEST(FreeSpace, DegenerateScansOpenNothing) {
  const auto open_m2 = [](const Scan& scan, const Laser& laser = {}, const FreeSpaceOptions& options = {}) {
    return area_m2(free_space_of(scan, laser, options));
  };
  Scan scan = half_turn(181, 5);
  scan.ranges_m.clear();
  EXPECT_EQ(open_m2(scan), 0) << "no beams";
  scan.ranges_m = {5};
  EXPECT_EQ(open_m2(scan), 0) << "one beam";
  EXPECT_EQ(open_m2(half_turn(181, nan_range)), 0);
  EXPECT_EQ(open_m2(half_turn(181, 0)), 0);
  Scan alternating = half_turn(181, 5);
  for (std::size_t i = 0; i < 181; i += 2) alternating.ranges_m[i] = nan_range;
  EXPECT_EQ(open_m2(alternating), 0) << "no two neighbouring beams";
  for (const double step : {0.0, std::nan(""), 1e-300, -1e-300, 4.0, -1e300}) {
    scan = half_turn(181, 5);
    scan.bearing_step_rad = step;
    EXPECT_EQ(open_m2(scan), 0) << step;
  }
  scan = half_turn(181, 5);
  scan.bearing0_rad = std::nan("");
  EXPECT_EQ(open_m2(scan), 0);
  Laser laser;
  laser.robot_from_laser.yaw = std::nan("");
  EXPECT_EQ(open_m2(half_turn(181, 5), laser), 0);
  laser.robot_from_laser = {1e300, 0, 0};
  EXPECT_EQ(open_m2(half_turn(181, 5), laser), 0);
  FreeSpaceOptions options;
  options.max_range_m = std::nan("");
  EXPECT_EQ(open_m2(half_turn(181, 5), {}, options), 0);
  options.max_range_m = -1;
  EXPECT_EQ(open_m2(half_turn(181, 5), {}, options), 0);
}

TEST(FreeSpace, TwoBeamsAreATriangle) {
  Scan scan;
  scan.bearing_step_rad = 0.5;
  scan.ranges_m = {2, 2};
  EXPECT_NEAR(area_m2(free_space_of(scan, {}, {})), 2 * std::sin(0.5), 1e-9);
}

TEST(FreeSpace, TinyRangesStaySound) {
  Laser laser;
  laser.range_min_m = 0;
  const Polysolid free = free_space_of(full_turn(360, 0.02F), laser, {});
  EXPECT_LE(area_m2(free), std::numbers::pi * 0.02 * 0.02);
  EXPECT_TRUE(free_space_of(full_turn(360, 1e-30F), laser, {}).empty());
}

}  // namespace
}  // namespace isthmus
