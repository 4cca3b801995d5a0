#include "patches/features/m_space.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace isthmus {
namespace {

TEST(MSpace, ASegmentGrowsFromTwoToFourDimensionsAsItsEndsAreSeen) {
  EXPECT_EQ(dimension(segment_feature({0, 0}, {0, 2}, false, false)), 2);
  EXPECT_EQ(dimension(segment_feature({0, 0}, {0, 2}, true, false)), 3);
  EXPECT_EQ(dimension(segment_feature({0, 0}, {0, 2}, false, true)), 3);
  EXPECT_EQ(dimension(segment_feature({0, 0}, {0, 2}, true, true)), 4);
}

TEST(MSpace, APolesRadiusAndACornersHeadingAreDimensionsOfTheirOwn) {
  Feature corner = corner_feature({1, 2}, 0.3, 1.5);
  EXPECT_EQ(dimension(corner), 3);
  corner.heading_known = false;
  EXPECT_EQ(dimension(corner), 2);
  EXPECT_EQ(dimension(pole_feature({1, 2}, 0.2, true)), 3);
  EXPECT_EQ(dimension(pole_feature({1, 2}, 0.2, false)), 2);
  EXPECT_EQ(dimension(point_feature({1, 2})), 2);
}

TEST(MSpace, LocalCoordinatesOfAWallAheadAreItsTurnDistanceAndEnds) {
  const Feature wall = segment_feature({5, -1}, {5, 3}, true, true);
  EXPECT_EQ(across(wall), Eigen::Vector2d(1, 0));  // away from an observer at the origin
  const Feature moved = segment_feature({5.2, -1.5}, {5.2, 3}, true, true);
  EXPECT_TRUE(local_coordinates(wall, moved).isApprox(Eigen::Vector4d(0, 0.2, -2.5, 2)));
}

TEST(MSpace, ALineSeenInPartMovesAcrossItselfOnly) {
  const Feature wall = segment_feature({5, -1}, {5, 3}, false, false);
  LocalVector delta(2);
  delta << 0, 0.3;
  const Feature moved = corrected(wall, delta);
  EXPECT_TRUE(moved.a.isApprox(Eigen::Vector2d(5.3, -1)));
  EXPECT_TRUE(moved.b.isApprox(Eigen::Vector2d(5.3, 3)));
}

TEST(MSpace, TheVarianceOfAWallDoesNotGrowWithItsDistanceFromTheOrigin) {
  const LocalMatrix of_ends = 1e-4 * LocalMatrix::Identity(4, 4);
  for (const double far_m : {0.0, 10.0, 1e5}) {
    const LocalMatrix b =
        project_to_local(segment_feature({far_m, far_m}, {far_m + 3, far_m + 4}, true, true));
    const Eigen::Matrix4d covariance = b * of_ends * b.transpose();
    EXPECT_NEAR(covariance(0, 0), 2e-4 / 25, 1e-12) << far_m;
    EXPECT_NEAR(covariance(1, 1), 0.5e-4, 1e-12) << far_m;
    EXPECT_NEAR(covariance(2, 2), 1e-4, 1e-12) << far_m;
  }
}

TEST(MSpace, AnUnknownEndMovedOnTellsTheSameLine) {
  const Feature wall = segment_feature({5, -1}, {5, 1}, true, false);
  const Stretched longer = stretched(wall, -9, 7);
  EXPECT_EQ(longer.feature.a, wall.a);  // a known end stays
  EXPECT_TRUE(longer.feature.b.isApprox(Eigen::Vector2d(5, 7)));
  LocalVector delta(3);
  delta << 1e-5, 1e-3, 1e-3;
  const Feature before = corrected(wall, delta), after = corrected(longer.feature, longer.change * delta);
  EXPECT_NEAR(local_coordinates(before, after)(0), 0, 1e-7);
  EXPECT_NEAR(local_coordinates(before, after)(1), 0, 1e-7);
  EXPECT_NEAR((before.a - after.a).norm(), 0, 1e-7);
}

TEST(MSpace, WhatIsNoFeatureIsToldApart) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_sound(segment_feature({1, 1}, {1, 1}, true, true)));
  EXPECT_FALSE(is_sound(point_feature({nan, 0})));
  EXPECT_FALSE(is_sound(pole_feature({0, 0}, -0.1, true)));
  EXPECT_FALSE(is_sound(corner_feature({0, 0}, nan, 1)));
  EXPECT_TRUE(is_sound(segment_feature({1, 1}, {1, 2}, false, false)));
}

TEST(MSpace, ACovarianceMustBePositiveDefiniteAndOfTheFeaturesSize) {
  ObservedFeature seen{point_feature({1, 2}), 0.01 * LocalMatrix::Identity(2, 2)};
  EXPECT_TRUE(is_sound(seen));
  seen.covariance.setZero();
  EXPECT_FALSE(is_sound(seen));
  seen.covariance << 1, 2, 2, 1;
  EXPECT_FALSE(is_sound(seen));
  seen.covariance = LocalMatrix::Identity(3, 3);
  EXPECT_FALSE(is_sound(seen));
}

}  // namespace
}  // namespace isthmus
