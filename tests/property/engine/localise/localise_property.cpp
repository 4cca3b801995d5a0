#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "server/engine/localise/extend.hpp"
#include "server/engine/localise/follow.hpp"
#include "tests/property/drawn.hpp"
#include "tests/support/localised.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

void assert_near(const Pose& a, const Pose& b) {
  RC_ASSERT(std::abs(a.x - b.x) < 1e-6);
  RC_ASSERT(std::abs(a.y - b.y) < 1e-6);
  RC_ASSERT(std::abs(wrap_angle(a.yaw - b.yaw)) < 1e-6);
}

Expectation expected(const Robot& robot, const Pose& odom_from_robot) {
  return expect(robot, odom_from_robot, 1'000'000, {});
}

// Eq. 11: only the change of odometry counts, not where its origin is.
TEST(ExpectProperty, DoesNotDependOnWhereOdometryBegan) {
  EXPECT_TRUE(rc::check([] {
    const Pose r = any_pose(3), odom_from_robot = any_pose(50), other_from_odom = any_pose(50);
    const Pose next = odom_from_robot * Pose{between(-1, 1), between(-0.2, 0.2), between(-1, 1)};
    const Expectation here = expected(robot_at(r, odom_from_robot), next);
    const Expectation there =
        expected(robot_at(r, other_from_odom * odom_from_robot), other_from_odom * next);
    RC_PRE(here.plausible && there.plausible);
    assert_near(here.local_from_robot, there.local_from_robot);
    RC_ASSERT(here.covariance.isApprox(there.covariance, 1e-6));
  }));
}

// To drive somewhere makes nobody surer of where that is.
TEST(ExpectProperty, NeverGrowsSurer) {
  EXPECT_TRUE(rc::check([] {
    Robot robot = robot_at(any_pose(3), {});
    const Eigen::Vector3d sigma(between(0.001, 0.3), between(0.001, 0.3), between(0.001, 0.2));
    robot.place->covariance = robot.place->tracking_covariance = sigma.cwiseProduct(sigma).asDiagonal();
    const Expectation expectation = expected(robot, {between(-1, 1), between(-1, 1), between(-1, 1)});
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(expectation.tracking_covariance);
    RC_ASSERT(axes.eigenvalues()(0) > 0);
    RC_ASSERT(expectation.tracking_covariance(2, 2) >= robot.place->tracking_covariance(2, 2));
    const auto area = [](const Eigen::Matrix3d& spread) {
      return Eigen::Matrix2d(spread.topLeftCorner<2, 2>()).determinant();
    };
    RC_ASSERT(area(expectation.tracking_covariance) >= area(robot.place->tracking_covariance));
  }));
}

// Eq. 14 is another name for the same place: whichever patch is chosen, the robot stays where it is.
TEST(FollowProperty, MovesNobodyInThePlane) {
  EXPECT_TRUE(rc::check([] {
    Map map;
    std::vector<Pose> poses;
    for (int i = *rc::gen::inRange(1, 6); i > 0; --i) poses.push_back(any_pose(2.5));
    add_way(map, furnished_room(), poses);
    Robot robot = robot_at({}, {});
    choose_local_map(map, robot, {}, map.manifold().patch(PatchId{0}).points, {});
    Placement placement;
    placement.matched = true;
    placement.local_from_robot = any_pose(3);
    placement.covariance = placement.tracking_covariance = Eigen::Vector3d(0.01, 0.04, 0.001).asDiagonal();
    follow(map, robot, Expectation{}, placement, {}, 1'000'000, {});
    assert_near(map.manifold().project(robot.place->pose),
                map.manifold().pose(PatchId{0}) * placement.local_from_robot);
    // The same ellipse, turned.
    const Eigen::Matrix2d its = robot.place->covariance.topLeftCorner<2, 2>();
    RC_ASSERT(std::abs(its.determinant() - 4e-4) < 1e-9);
    RC_ASSERT(std::abs(its.trace() - 0.05) < 1e-9);
  }));
}

TEST(UncoveredShareProperty, FallsWithEveryPatchThatLooks) {
  EXPECT_TRUE(rc::check([] {
    const PatchPtr patch = patch_from(furnished_room(), PatchId{0}, {});
    const Pose local_from_robot = any_pose(2);
    std::vector<LocalPatch> patches;
    double before = 1;
    for (int i = 0; i < 4; ++i) {
      patches.push_back({patch, any_pose(2)});
      const double share = uncovered_share(patch->star, patches, local_from_robot, {});
      RC_ASSERT(share >= 0 && share <= before);
      before = share;
    }
  }));
}

}  // namespace
}  // namespace isthmus
