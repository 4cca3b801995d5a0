#include "server/engine/localise/seen_step.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/localised.hpp"
#include "tests/support/poses.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr std::int64_t between_scans_us = 200'000;
constexpr std::int64_t before_us = 1'000'000;
constexpr std::int64_t now_us = before_us + between_scans_us;

// A robot that stood at `truth` among the walls when it scanned last, by its map at r, by its odometry at 0.
Robot robot_that_saw(const Walls& walls, const Pose& truth, const Pose& r = {1, 2, 0.7}) {
  Robot robot = robot_at(r);
  robot.declaration.robot = "R1";
  robot.declaration.laser = laser_of();
  robot.place->utime = before_us;
  robot.place->covariance = Eigen::Vector3d(0.04, 0.01, 0.0025).asDiagonal();
  robot.place->tracking_covariance = 0.25 * robot.place->covariance;
  robot.last_scan = scan_from(walls, truth, before_us);
  return robot;
}

std::optional<Expectation> expected(const Robot& robot, const Pose& odometry, const Walls& walls,
                                    const Pose& truth, const EngineOptions& options = {}) {
  const std::vector<ScanPoint> points = to_points(scan_from(walls, truth, now_us), laser_of(), {});
  return expect_as_seen(robot, odometry, points, now_us, options);
}

TEST(ExpectAsSeen, TellsTheTurnThatOdometryMissed) {
  const Pose was{0.4, -0.3, 0.2}, step{0.08, 0.01, 0.3};
  const Robot robot = robot_that_saw(furnished_room(), was);
  const std::optional<Expectation> seen = expected(robot, {}, furnished_room(), was * step);
  ASSERT_TRUE(seen);
  EXPECT_TRUE(seen->seen);
  expect_near(seen->step, step, 0.02, 0.006);
  expect_near(seen->local_from_robot, robot.place->pose.patch_from_object * seen->step, 1e-9, 1e-9);
  EXPECT_EQ(seen->claimed_step, Pose{}) << "what odometry said is not forgotten";
}

// A robot of its own knows no more of where it was than before, and of the step what two scans tell.
TEST(ExpectAsSeen, ErrsByTheStepBeyondWhatThePlaceErredBy) {
  const Pose was{0.4, -0.3, 0.2}, step{0.08, 0.01, 0.3};
  const Robot robot = robot_that_saw(furnished_room(), was);
  const std::optional<Expectation> seen = expected(robot, {}, furnished_room(), was * step);
  ASSERT_TRUE(seen);
  const ComposeJacobians j = compose_jacobians(robot.place->pose.patch_from_object, seen->step);
  const Eigen::Matrix3d placed = j.by_left * robot.place->covariance * j.by_left.transpose();
  const Eigen::Matrix3d stepped = j.by_right * seen->step_covariance * j.by_right.transpose();
  EXPECT_TRUE(seen->covariance.isApprox(placed + stepped, 1e-6));
  EXPECT_LT(std::sqrt(seen->step_covariance(2, 2)), 0.01);
  EXPECT_LT(std::sqrt(seen->step_covariance.topLeftCorner<2, 2>().trace()), 0.03);
  EXPECT_GT(seen->tracking_covariance.trace(), robot.place->tracking_covariance.trace());
  EXPECT_LT(seen->tracking_covariance.trace(), seen->covariance.trace());
}

// Along a corridor two scans tell nothing.
TEST(ExpectAsSeen, LeavesToOdometryWhatScansDoNotTell) {
  const Robot robot = robot_that_saw(corridor(), {}, {});
  const std::optional<Expectation> seen = expected(robot, {0.2, 0.02, 0.01}, corridor(), {0.25, 0, 0.03});
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->step.x, 0.2, 0.01);
  EXPECT_NEAR(seen->step.y, 0, 0.01);
  EXPECT_NEAR(seen->step.yaw, 0.03, 0.005);
  EXPECT_GT(seen->step_covariance(0, 0), 4 * seen->step_covariance(1, 1));
  EXPECT_LT(seen->step_covariance(0, 0), 0.1 * robot.place->covariance(0, 0)) << "the step alone errs";
}

// Wheels that slip in a turn: odometry, which tells a quarter of it again, errs as it did in the scan before.
TEST(ExpectAsSeen, BelievesOdometryToErrOnAsItDid) {
  const Walls somewhere = [] {
    Walls walls;
    add_box(walls, 2, -0.25, 2.2, 0.25);  // all that it sees
    return walls;
  }();
  const Pose step{0, 0, 0.4};
  Robot robot = robot_that_saw(somewhere, {0, 0, -0.2}, {});
  const auto turn = [&] { return expected(robot, {0, 0, 0.1}, somewhere, Pose{0, 0, -0.2} * step); };
  const std::optional<Expectation> at_first = turn();
  for (int i = 0; i < 3; ++i) robot.turn_error.learn(0.3, 1e-4, {});
  const std::optional<Expectation> again = turn();
  ASSERT_TRUE(again);
  EXPECT_NEAR(again->step.yaw, step.yaw, 0.01);
  EXPECT_TRUE(!at_first || std::abs(at_first->step.yaw - step.yaw) > 0.05) << "one scan alone does not tell";
}

TEST(ExpectAsSeen, IsNothingWhereTheScanBeforeShowsAnotherPlace) {
  const Robot robot = robot_that_saw(corridor(), {}, {});
  Walls closet;
  add_box(closet, -0.7, -0.5, 0.6, 0.4);
  EXPECT_FALSE(expected(robot, {0.1, 0, 0}, closet, {}));
}

TEST(ExpectAsSeen, IsNothingWhereTheScanBeforeIsNotTheOneThatTheRobotWasPlacedBy) {
  Robot robot = robot_that_saw(furnished_room(), {});
  EXPECT_TRUE(expected(robot, {0.1, 0, 0}, furnished_room(), {0.1, 0, 0}));
  robot.place->utime -= between_scans_us;
  EXPECT_FALSE(expected(robot, {0.1, 0, 0}, furnished_room(), {0.1, 0, 0}));
  robot.place->utime = 0;
  robot.last_scan = {};
  EXPECT_FALSE(expected(robot, {0.1, 0, 0}, furnished_room(), {0.1, 0, 0})) << "it has seen none";
}

// Where scans fit badly, as amid legs of tables, they do not outweigh odometry.
TEST(ExpectAsSeen, IsADoubtfulFitOnlyWhereOdometryAgrees) {
  EngineOptions all_are_doubtful;
  all_are_doubtful.localise.common.doubtful_score = 1.1;
  all_are_doubtful.correlative.max_evaluations = 1;  // and none is found anew
  const Pose truth{0.08, 0.01, 0.1};
  const Robot robot = robot_that_saw(furnished_room(), {});
  const auto seen = [&](const Pose& odometry) {
    return expected(robot, odometry, furnished_room(), truth, all_are_doubtful);
  };
  const std::optional<Expectation> agreed = seen({0.085, 0.01, 0.1});
  ASSERT_TRUE(agreed);
  expect_near(agreed->step, truth, 0.01, 0.005);
  EXPECT_FALSE(seen({0.5, 0.01, 0.1}));
}

// No robot moves as its odometry says: what two scans show is what there is.
TEST(ExpectAsSeen, IsWhereScansAgreeAlsoWhereOdometryIsImplausible) {
  const Pose was{0.4, -0.3, 0.2}, step{0.08, 0.01, 0.1};
  const Robot robot = robot_that_saw(furnished_room(), was);
  const std::optional<Expectation> seen = expected(robot, {30, 4, 1}, furnished_room(), was * step);
  ASSERT_TRUE(seen);
  expect_near(seen->step, step, 0.02, 0.006);
  EXPECT_TRUE(seen->is_known());
  EXPECT_FALSE(seen->plausible) << "odometry is none to learn from";
}

}  // namespace
}  // namespace isthmus
