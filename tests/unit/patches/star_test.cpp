#include "patches/star.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/patch_scenes.hpp"

namespace isthmus {
namespace {

using testing::full_turn;
using testing::half_turn;
using testing::infinite_range;
using testing::nan_range;

Eigen::Vector2d polar(double bearing_rad, double range_m) {
  return {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad)};
}

TEST(Star, DepthIsTheDistanceInFrontOfTheObstacle) {
  Scan scan = half_turn(181, 4);
  scan.ranges_m[0] = 10;
  Laser laser;
  laser.robot_from_laser = {1, 2, std::numbers::pi / 2};
  const Star star(scan, laser, 20, 0);
  EXPECT_NEAR(star.depth_m({1, 5}), 1, 1e-5);
  EXPECT_NEAR(star.depth_m({1, 7}), -1, 1e-5);
  EXPECT_TRUE(star.contains({1, 5}));
  EXPECT_FALSE(star.contains({1, 7}));
  EXPECT_FLOAT_EQ(static_cast<float>(star.reach_m()), 10);
}

TEST(Star, NothingIsKnownBehindTheLaserOrBeyondItsReach) {
  const Star star(half_turn(181, 4), {}, 20, 0);
  EXPECT_TRUE(star.contains(polar(1.5, 3)));
  EXPECT_EQ(star.depth_m(polar(std::numbers::pi, 3)), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(star.depth_m(polar(-2, 3)), -std::numeric_limits<double>::infinity());
  EXPECT_FALSE(star.contains({100, 0}));
}

TEST(Star, FullTurnHasNoSeam) {
  const Star star(full_turn(360, 4), {}, 20, 0);
  for (int i = 0; i < 10000; ++i)
    EXPECT_TRUE(star.contains(polar(i * 2 * std::numbers::pi / 10000, 3.9))) << i;
}

TEST(Star, IgnoredBeamsAndNoReturnsOpenOnlyWhatIsAllowed) {
  Scan scan = half_turn(181, 4);
  scan.ranges_m[90] = nan_range;
  scan.ranges_m[120] = infinite_range;
  const double bearing = testing::bearing_rad(scan, 120);
  const Star strict(scan, {}, 20, 0);
  EXPECT_FALSE(strict.contains(polar(0, 1)));
  EXPECT_FALSE(strict.contains(polar(bearing, 1)));
  for (const double unknown : {0.0, bearing})
    EXPECT_EQ(strict.depth_m(polar(unknown, 1)), -std::numeric_limits<double>::infinity())
        << "no obstacle either";
  const Star lenient(scan, {}, 20, 2);
  EXPECT_FALSE(lenient.contains(polar(0, 1)));
  EXPECT_TRUE(lenient.contains(polar(bearing, 1)));
  EXPECT_FALSE(lenient.contains(polar(bearing, 2.5)));
}

TEST(Star, BeamsAreCutAtTheMaximum) {
  const Star star(half_turn(181, 50), {}, 20, 0);
  EXPECT_TRUE(star.contains({19.9, 0}));
  EXPECT_FALSE(star.contains({20.1, 0}));
}

TEST(Star, NegativeStepIsTheSameStar) {
  Scan scan = half_turn(181, 0);
  testing::look_at(scan, {{0.3, 3}, {-1.0, 2}, {1.4, 2.5}});
  const Star star(scan, {}, 20, 0);
  const Star other(testing::reversed(scan), {}, 20, 0);
  EXPECT_EQ(star.ranges_m(), other.ranges_m());
  EXPECT_NEAR(star.bearing0_rad(), other.bearing0_rad(), 1e-12);
  EXPECT_EQ(star.bearing_step_rad(), other.bearing_step_rad());
}

TEST(Star, DegenerateScansContainNothing) {
  const auto empty = [](const Scan& scan) {
    const Star star(scan, {}, 20, 0);
    return !star.contains({0, 0}) && !star.contains({1, 0}) && !star.contains({-1, 1});
  };
  EXPECT_FALSE(Star().contains({0, 0}));
  Scan scan = half_turn(181, 5);
  scan.ranges_m.clear();
  EXPECT_TRUE(empty(scan));
  EXPECT_TRUE(empty(half_turn(181, nan_range)));
  EXPECT_TRUE(empty(half_turn(181, infinite_range)));
  for (const double step : {0.0, std::nan("")}) {
    scan = half_turn(181, 5);
    scan.bearing_step_rad = step;
    EXPECT_TRUE(empty(scan)) << step;
  }
  scan = half_turn(181, 5);
  scan.bearing0_rad = std::nan("");
  EXPECT_TRUE(empty(scan));
}

TEST(Star, PointsAtNoPlaceAreNotFree) {
  const Star star(full_turn(360, 4), {}, 20, 0);
  EXPECT_FALSE(star.contains({std::nan(""), 0}));
  EXPECT_FALSE(star.contains({std::numeric_limits<double>::infinity(), 0}));
  Scan narrow = half_turn(181, 4);
  narrow.bearing_step_rad = 1e-300;
  EXPECT_FALSE(Star(narrow, {}, 20, 0).contains({-1, 1}));
}

}  // namespace
}  // namespace isthmus
