#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <numbers>

#include "patches/features/m_space.hpp"
#include "tests/property/drawn.hpp"

namespace isthmus {
namespace {

using testing::any_pose;
using testing::between;

Eigen::Vector2d any_point(double reach_m) { return {between(-reach_m, reach_m), between(-reach_m, reach_m)}; }

/// Any kind, with any part of it known, up to 100 m away.
Feature any_feature() {
  const Eigen::Vector2d place = any_point(100);
  const double yaw = between(-std::numbers::pi, std::numbers::pi);
  const bool one = *rc::gen::arbitrary<bool>(), other = *rc::gen::arbitrary<bool>();
  switch (*rc::gen::inRange(0, 4)) {
    case 0:
      return segment_feature(place, place + rotate(yaw, {between(0.2, 20), 0}), one, other);
    case 1: {
      Feature corner = corner_feature(place, yaw, between(0.3, 5));
      corner.heading_known = one;
      return corner;
    }
    case 2:
      return pole_feature(place, between(0.1, 0.5), one);
    default:
      return point_feature(place);
  }
}

TEST(MSpaceProperty, BIsTheInverseOfBTildeOnWhatIsKnown) {
  EXPECT_TRUE(rc::check([] {
    const Feature feature = any_feature();
    const LocalMatrix b = project_to_local(feature), b_tilde = project_to_feature(feature);
    const int q = dimension(feature);
    RC_ASSERT(b.rows() == q && b_tilde.cols() == q);
    RC_ASSERT((b * b_tilde).isApprox(LocalMatrix::Identity(q, q), 1e-9));
    const LocalMatrix projection = b_tilde * b;
    RC_ASSERT((projection * projection).isApprox(projection, 1e-9));
    if (q == coordinate_count(feature.kind))
      RC_ASSERT(projection.isApprox(LocalMatrix::Identity(q, q), 1e-9));
  }));
}

TEST(MSpaceProperty, TheJacobianInAnyFrameIsTheNumericOne) {
  EXPECT_TRUE(rc::check([] {
    const Feature feature = any_feature();
    Feature frame = Pose{between(-1, 1), between(-1, 1), between(-1, 1)} * feature;
    frame.radius_m = between(0.1, 0.5);
    const LocalMatrix exact = local_jacobian(frame, feature);
    constexpr double step = 1e-5;
    for (int k = 0; k < coordinate_count(feature.kind); ++k) {
      LocalVector more = coordinates(feature), less = more;
      more(k) += step;
      less(k) -= step;
      const LocalVector numeric =
          local_difference(feature.kind, local_coordinates(frame, with_coordinates(feature, more)),
                           local_coordinates(frame, with_coordinates(feature, less))) /
          (2 * step);
      RC_ASSERT((numeric - exact.col(k)).norm() < 1e-4 * (1 + exact.col(k).norm()));
    }
  }));
}

TEST(MSpaceProperty, BTildeIsTheNumericDerivativeOfTheCorrection) {
  EXPECT_TRUE(rc::check([] {
    const Feature feature = any_feature();
    const LocalMatrix b_tilde = project_to_feature(feature);
    constexpr double step = 1e-6;
    for (int k = 0; k < dimension(feature); ++k) {
      const LocalVector delta = step * LocalMatrix::Identity(dimension(feature), dimension(feature)).col(k);
      const LocalVector numeric =
          (coordinates(corrected(feature, delta)) - coordinates(corrected(feature, -delta))) / (2 * step);
      RC_ASSERT((numeric - b_tilde.col(k)).norm() < 1e-6 * (1 + b_tilde.col(k).norm()));
    }
  }));
}

TEST(MSpaceProperty, LocalCoordinatesDoNotDependOnTheFrameOfTheMap) {
  EXPECT_TRUE(rc::check([] {
    const Feature feature = any_feature();
    RC_PRE(point_count(feature.kind) == 2);  // those of points and poles have the axes of the map
    const Feature frame = Pose{between(-1, 1), between(-1, 1), between(-1, 1)} * feature;
    const Pose motion = any_pose(50);
    RC_ASSERT(local_coordinates(motion * frame, motion * feature)
                  .isApprox(local_coordinates(frame, feature), 1e-8));
    RC_ASSERT(std::abs(project_to_local(motion * feature).norm() - project_to_local(feature).norm()) < 1e-9);
  }));
}

TEST(MSpaceProperty, ARigidMotionOfAKnownFeatureIsWhollyKept) {
  EXPECT_TRUE(rc::check([] {
    Feature feature = any_feature();
    feature.end_a_known = feature.end_b_known = feature.heading_known = feature.radius_known = true;
    const Feature moved = Pose{between(-1e-4, 1e-4), between(-1e-4, 1e-4), between(-1e-6, 1e-6)} * feature;
    const LocalVector delta = project_to_local(feature) * (coordinates(moved) - coordinates(feature));
    RC_ASSERT((coordinates(corrected(feature, delta)) - coordinates(moved)).norm() < 1e-8);
  }));
}

}  // namespace
}  // namespace isthmus
