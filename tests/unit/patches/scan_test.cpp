#include "patches/scan.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "tests/support/patch_scenes.hpp"

namespace isthmus {
namespace {

using testing::half_turn;
using testing::infinite_range;
using testing::look_at;
using testing::nan_range;
using testing::reversed;

TEST(Scan, RangesAreClassifiedByRep117) {
  Laser laser;
  laser.range_min_m = 0.5;
  laser.range_max_m = 10;
  EXPECT_EQ(classify(5, laser), BeamKind::hit);
  EXPECT_EQ(classify(0.5F, laser), BeamKind::hit);
  EXPECT_EQ(classify(9.99F, laser), BeamKind::hit);
  EXPECT_EQ(classify(10, laser), BeamKind::no_return);
  EXPECT_EQ(classify(11, laser), BeamKind::no_return);
  EXPECT_EQ(classify(infinite_range, laser), BeamKind::no_return);
  for (const float range_m : {0.49F, 0.0F, -0.0F, -5.0F, -infinite_range, nan_range}) {
    EXPECT_EQ(classify(range_m, laser), BeamKind::ignored) << range_m;
  }
}

TEST(Scan, ZeroRangeIsIgnoredEvenWithoutAMinimum) {
  Laser laser;
  laser.range_min_m = 0;
  EXPECT_EQ(classify(0, laser), BeamKind::ignored);
  EXPECT_EQ(classify(1e-3F, laser), BeamKind::hit);
}

TEST(Scan, InfinityIsNoReturnAlsoForALaserWithoutAMaximum) {
  Laser laser;
  laser.range_max_m = std::numeric_limits<double>::infinity();
  EXPECT_EQ(classify(infinite_range, laser), BeamKind::no_return);
  EXPECT_EQ(classify(1e6F, laser), BeamKind::hit);
}

TEST(Scan, ALargestRangeThatNoFloatIsIsNoReturnToo) {
  Laser laser;
  laser.range_max_m = 5.6;
  ASSERT_LT(5.6F, laser.range_max_m);
  EXPECT_EQ(classify(5.6F, laser), BeamKind::no_return);
  EXPECT_EQ(classify(5.59F, laser), BeamKind::hit);
}

TEST(Scan, PointsAreTheHitsInTheRobotsFrame) {
  Scan scan;
  scan.bearing0_rad = 0;
  scan.bearing_step_rad = std::numbers::pi / 2;
  scan.ranges_m = {1, infinite_range, 3, nan_range, 2};
  Laser laser;
  laser.robot_from_laser = {0.5, 0.25, std::numbers::pi / 2};
  const auto points = to_points(scan, laser, {});
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].beam, 0);
  EXPECT_EQ(points[1].beam, 2);
  EXPECT_EQ(points[2].beam, 4);
  EXPECT_NEAR((points[0].position - Eigen::Vector2d(0.5, 1.25)).norm(), 0, 1e-6);
  EXPECT_NEAR((points[1].position - Eigen::Vector2d(0.5, -2.75)).norm(), 0, 1e-6);
}

TEST(Scan, NegativeStepGivesTheSamePointsInTheOtherOrder) {
  Scan scan = half_turn(181, 0);
  look_at(scan, {{0.3, 3}, {-1.0, 2}, {1.4, 2.5}});
  const auto points = to_points(scan, {}, {});
  const auto other = to_points(reversed(scan), {}, {});
  ASSERT_EQ(points.size(), other.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ScanPoint& same = other[other.size() - 1 - i];
    EXPECT_NEAR((points[i].position - same.position).norm(), 0, 1e-6);
    EXPECT_NEAR((points[i].normal - same.normal).norm(), 0, 1e-6);
    EXPECT_EQ(points[i].beam + same.beam, 180);
  }
}

TEST(Scan, DegenerateScansGivePointsWithoutNormalsOrNone) {
  Scan scan = half_turn(181, 5);
  scan.ranges_m.clear();
  EXPECT_TRUE(to_points(scan, {}, {}).empty());
  EXPECT_TRUE(to_points(half_turn(181, nan_range), {}, {}).empty());
  EXPECT_TRUE(to_points(half_turn(181, infinite_range), {}, {}).empty());
  scan = half_turn(181, 5);
  scan.bearing_step_rad = 0;
  for (const ScanPoint& point : to_points(scan, {}, {}))
    EXPECT_FALSE(point.has_normal()) << "all in one place";
  scan.ranges_m = {5};
  ASSERT_EQ(to_points(scan, {}, {}).size(), 1U);
  EXPECT_FALSE(to_points(scan, {}, {})[0].has_normal());
}

}  // namespace
}  // namespace isthmus
