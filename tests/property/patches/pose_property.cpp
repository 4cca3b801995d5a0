#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "patches/pose.hpp"
#include "random_solids.hpp"
#include "tests/property/drawn.hpp"

namespace isthmus {
namespace {

using testing::between;

/// Its heading may lie a little beyond half a turn.
Pose pose_to_wrap() { return {between(-50, 50), between(-50, 50), between(-3.2, 3.2)}; }

void expect_same(const Pose& a, const Pose& b) {
  RC_ASSERT(std::abs(a.x - b.x) < 1e-9);
  RC_ASSERT(std::abs(a.y - b.y) < 1e-9);
  RC_ASSERT(std::abs(wrap_angle(a.yaw - b.yaw)) < 1e-9);
}

// Central differences of a pose-valued function; differences of yaw are wrapped.
Eigen::Matrix3d numeric_jacobian(const std::function<Pose(const Pose&)>& function, const Pose& at) {
  constexpr double h = 1e-5;
  Eigen::Matrix3d jacobian;
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    step[k] = h;
    const Pose up = function(to_pose(to_vector(at) + step));
    const Pose down = function(to_pose(to_vector(at) - step));
    jacobian.col(k) << up.x - down.x, up.y - down.y, wrap_angle(up.yaw - down.yaw);
  }
  return jacobian / (2 * h);
}

void expect_same(const Eigen::Matrix3d& analytic, const Eigen::Matrix3d& numeric) {
  RC_ASSERT((analytic - numeric).cwiseAbs().maxCoeff() < 1e-6);
}

TEST(PoseProperty, IdentityChangesNothing) {
  EXPECT_TRUE(rc::check([] {
    const Pose pose = pose_to_wrap();
    expect_same(pose * Pose{}, pose);
    expect_same(Pose{} * pose, pose);
  }));
}

TEST(PoseProperty, InverseUndoes) {
  EXPECT_TRUE(rc::check([] {
    const Pose pose = pose_to_wrap();
    expect_same(pose * inverse(pose), {});
    expect_same(inverse(pose) * pose, {});
  }));
}

TEST(PoseProperty, CompositionIsAssociative) {
  EXPECT_TRUE(rc::check([] {
    const Pose a = pose_to_wrap();
    const Pose b = pose_to_wrap();
    const Pose c = pose_to_wrap();
    expect_same((a * b) * c, a * (b * c));
  }));
}

TEST(PoseProperty, CompositionActsOnPointsOneAfterTheOther) {
  EXPECT_TRUE(rc::check([] {
    const Pose a = pose_to_wrap();
    const Pose b = pose_to_wrap();
    const Eigen::Vector2d point(between(-50, 50), between(-50, 50));
    RC_ASSERT(((a * b) * point - a * (b * point)).norm() < 1e-9);
  }));
}

TEST(PoseProperty, OminusUndoesOplus) {
  EXPECT_TRUE(rc::check([] {
    const Pose pi = pose_to_wrap();
    const Pose r = pose_to_wrap();
    expect_same(ominus(pi * r, pi), r);
    expect_same(ominus(r, pi), inverse(pi) * r);
  }));
}

TEST(PoseProperty, WrappedAngleIsInRangeAndTheSameDirection) {
  EXPECT_TRUE(rc::check([] {
    const double angle = between(-1000, 1000);
    const double wrapped = wrap_angle(angle);
    RC_ASSERT(wrapped > -std::numbers::pi && wrapped <= std::numbers::pi);
    RC_ASSERT(std::abs(std::remainder(angle - wrapped, 2 * std::numbers::pi)) < 1e-9);
  }));
}

TEST(PoseProperty, WrappedDifferenceIsTheStepThatLeadsFromOnePoseToTheOther) {
  EXPECT_TRUE(rc::check([] {
    const Pose a = pose_to_wrap();
    const Pose b = pose_to_wrap();
    const Eigen::Vector3d step = wrapped_difference(a, b);
    RC_ASSERT(step.z() > -std::numbers::pi && step.z() <= std::numbers::pi);
    expect_same(to_pose(to_vector(b) + step), a);
  }));
}

TEST(PoseProperty, PointJacobianIsTheDerivative) {
  EXPECT_TRUE(rc::check([] {
    const Pose pose = pose_to_wrap();
    const Eigen::Vector2d point(between(-50, 50), between(-50, 50));
    const auto moved = [&](const Pose& a_from_b) { return a_from_b * Pose{point.x(), point.y(), 0}; };
    Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
    expected.topRows<2>() = point_jacobian(pose, point);
    expected(2, 2) = 1;  // the yaw of what is moved along
    expect_same(expected, numeric_jacobian(moved, pose));
  }));
}

TEST(PoseProperty, ComposeJacobiansAreTheDerivatives) {
  EXPECT_TRUE(rc::check([] {
    const Pose a = pose_to_wrap();
    const Pose b = pose_to_wrap();
    const ComposeJacobians jacobians = compose_jacobians(a, b);
    expect_same(jacobians.by_left, numeric_jacobian([&](const Pose& left) { return left * b; }, a));
    expect_same(jacobians.by_right, numeric_jacobian([&](const Pose& right) { return a * right; }, b));
  }));
}

TEST(PoseProperty, OminusJacobiansAreTheDerivatives) {
  EXPECT_TRUE(rc::check([] {
    const Pose q = pose_to_wrap();
    const Pose pi = pose_to_wrap();
    const OminusJacobians jacobians = ominus_jacobians(q, pi);
    expect_same(jacobians.by_q, numeric_jacobian([&](const Pose& p) { return ominus(p, pi); }, q));
    expect_same(jacobians.by_pi, numeric_jacobian([&](const Pose& p) { return ominus(q, p); }, pi));
  }));
}

TEST(PoseProperty, InverseJacobianIsTheDerivative) {
  EXPECT_TRUE(rc::check([] {
    const Pose pose = pose_to_wrap();
    expect_same(inverse_jacobian(pose), numeric_jacobian([](const Pose& p) { return inverse(p); }, pose));
  }));
}

}  // namespace
}  // namespace isthmus
