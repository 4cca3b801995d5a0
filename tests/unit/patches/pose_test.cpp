#include "patches/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace isthmus {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Pose, AnglesWrapIntoTheHalfOpenInterval) {
  EXPECT_EQ(wrap_angle(pi), pi);
  EXPECT_EQ(wrap_angle(-pi), pi) << "-pi is pi";
  EXPECT_NEAR(wrap_angle(3 * pi / 2), -pi / 2, 1e-15);
  EXPECT_NEAR(wrap_angle(7 * pi + 0.1), -pi + 0.1, 1e-12);
  EXPECT_EQ(wrap_angle(0.25), 0.25);
}

TEST(Pose, CompositionPlacesTheSecondInTheFrameOfTheFirst) {
  const Pose map_from_robot = Pose{1, 2, pi / 2} * Pose{3, 0, pi};
  EXPECT_NEAR(map_from_robot.x, 1, 1e-12);
  EXPECT_NEAR(map_from_robot.y, 5, 1e-12);
  EXPECT_NEAR(map_from_robot.yaw, -pi / 2, 1e-12);
}

TEST(Pose, OminusIsThePoseSeenFromTheOther) {
  const Pose seen = ominus({1, 5, -pi / 2}, {1, 2, pi / 2});
  EXPECT_NEAR(seen.x, 3, 1e-12);
  EXPECT_NEAR(seen.y, 0, 1e-12);
  EXPECT_NEAR(std::abs(seen.yaw), pi, 1e-12);
}

TEST(Pose, FiniteMeansAllThreeComponents) {
  const double nan = std::nan("");
  EXPECT_TRUE(is_finite({1, 2, 3}));
  EXPECT_FALSE(is_finite({nan, 2, 3}));
  EXPECT_FALSE(is_finite({1, std::numeric_limits<double>::infinity(), 3}));
  EXPECT_FALSE(is_finite({1, 2, nan}));
}

}  // namespace
}  // namespace isthmus
