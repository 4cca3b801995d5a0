#include "server/engine/localise/expectation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/localised.hpp"
#include "tests/support/poses.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

Expectation expected(const Robot& robot, const Pose& odom_from_robot, double seconds = 1) {
  return expect(robot, odom_from_robot, static_cast<std::int64_t>(seconds * 1e6), {});
}

// Eq. 11: the robot's pose on its patch, followed by the change in pose that odometry measured.
TEST(Expect, PutsTheRobotWhereOdometrySays) {
  const Expectation ahead = expected(robot_at({1, 2, quarter_turn}, {5, 5, 0}), {6, 5, 0.1});
  expect_near(ahead.step, {1, 0, 0.1});
  expect_near(ahead.local_from_robot, {1, 3, quarter_turn + 0.1});
  EXPECT_TRUE(ahead.plausible);
  // Where odometry's frame lies says nothing.
  const Expectation turned =
      expected(robot_at({1, 2, quarter_turn}, {5, 5, quarter_turn}), {5, 6, 1.6707963});
  expect_near(turned.local_from_robot, ahead.local_from_robot, 1e-6, 1e-6);
}

TEST(Expect, TakesOutWhatOdometryErrsByAlways) {
  Robot robot = robot_at({});
  for (int i = 0; i < 2000; ++i)
    robot.bias.learn({0.1, 0, 0}, 0, {0.1, 0, 0.003}, 1e-4 * Eigen::Matrix3d::Identity(),
                     Eigen::Matrix2d::Identity(), {}, {});
  const Expectation expectation = expected(robot, {0.5, 0, 0});
  EXPECT_NEAR(expectation.step.yaw, 0.015, 0.001);
  expect_near(expectation.claimed_step, {0.5, 0, 0});
}

// A yaw that is wrong by d puts the end of a step of 2 m aside by 2 d.
TEST(Expect, CarriesTheUncertaintyOfYawToTheEndOfTheStep) {
  Robot robot = robot_at({});
  const Expectation without = expected(robot, {2, 0, 0});
  robot.place->covariance(2, 2) = 0.01;
  robot.place->tracking_covariance(2, 2) = 0.04;
  const Expectation with = expected(robot, {2, 0, 0});
  Eigen::Matrix3d carried;
  carried << 0, 0, 0, 0, 4, 2, 0, 2, 1;
  EXPECT_TRUE((with.covariance - without.covariance).isApprox(0.01 * carried, 1e-9));
  EXPECT_TRUE((with.tracking_covariance - without.tracking_covariance).isApprox(0.04 * carried, 1e-9));
}

TEST(Expect, AddsTheNoiseOfOdometryInTheRobotsOwnDirections) {
  const Robot ahead = robot_at({0, 0, 0});
  const Robot aside = robot_at({0, 0, quarter_turn});
  const Pose step{1, 0.4, 0.2};
  const Eigen::Matrix3d noise = ahead.noise.covariance(step, {});
  EXPECT_TRUE(expected(ahead, step).covariance.isApprox(noise, 1e-9));
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << 0, -1, 1, 0;
  EXPECT_TRUE(expected(aside, step).covariance.isApprox(turn * noise * turn.transpose(), 1e-9));
}

// Odometry froze while the robot turned by 60 degrees, which scans showed: then it tells them all at once.
// Wheels that slip in a turn do so to its end: of n scans that are not matched the error is n times that of
// one.
TEST(Expect, AddsUpWhatOdometryErrsByWhileNoScanIsMatched) {
  const EngineOptions options;
  Robot robot = robot_at({});
  const Pose step{0.1, 0, 0.2};
  const auto noise = [&] { return expect(robot, step, 200'000, options).step_covariance; };
  const Eigen::Matrix3d of_one = noise();
  Eigen::Matrix3d sum = of_one;
  for (robot.place->unseen_steps = 1; robot.place->unseen_steps < 5; ++robot.place->unseen_steps)
    sum += noise();
  EXPECT_TRUE(sum.isApprox(5 * 5 * of_one, 1e-9));
}

TEST(Expect, TakesWhatOdometryHadNotToldOutOfAStepThatTellsIt) {
  Robot robot = robot_at({1, 0, 0.2});
  robot.place->untold = {0.1, 0, 1.05};
  robot.place->last_step = {0.02, 0, 0.2};
  const Pose going_on{0.02, 0, 0.19};
  const Expectation expectation = expected(robot, robot.place->untold * going_on, 0.25);
  EXPECT_TRUE(expectation.catches_up);
  EXPECT_TRUE(expectation.plausible) << "as a whole no robot turns like that";
  expect_near(expectation.step, going_on);
  expect_near(expectation.local_from_robot, robot.place->pose.patch_from_object * going_on);
}

// Odometry froze and goes on from where it stopped, or only told late that the robot began to move.
TEST(Expect, TakesAStepAsItIsWhereItIsLikeTheLastOne) {
  Robot robot = robot_at({1, 0, 0.2});
  robot.place->untold = {0.1, 0, 1.05};
  robot.place->last_step = {0.02, 0, 0.2};
  const Expectation expectation = expected(robot, {0.02, 0, 0.19}, 0.25);
  EXPECT_FALSE(expectation.catches_up);
  expect_near(expectation.step, {0.02, 0, 0.19});
  robot.place->untold = {};
  EXPECT_FALSE(expected(robot, {0.02, 0, 0.19}, 0.25).catches_up);
}

// Odometry that stands still may have frozen as the robot began to turn.
TEST(Expect, DoubtsHowFarARobotTurnedWhoseOdometryStopped) {
  Robot stopped = robot_at({});
  stopped.place->last_step = stopped.place->last_told = {0.16, 0, -0.02};
  const auto sigma_rad = [](const Robot& robot) {
    return std::sqrt(expected(robot, {}, 0.25).step_covariance(2, 2));
  };
  EXPECT_GT(sigma_rad(stopped), 0.2);
  EXPECT_LT(sigma_rad(robot_at({})), 0.05) << "of one that stood";
}

TEST(Expect, DoubtsThatARobotStandsUntilAScanShowsIt) {
  Robot robot = robot_at({});
  robot.place->last_told = {0.16, 0, -0.02};
  robot.place->last_step = {};
  const auto sigmas = [&]() -> Eigen::Vector3d {
    return expected(robot, {}, 0.25).step_covariance.diagonal().cwiseSqrt();
  };
  EXPECT_LT(sigmas().x(), 0.05) << "a scan showed it";
  robot.place->unseen_steps = 1;
  EXPECT_GT(sigmas().x(), 0.08);
  EXPECT_GT(sigmas().z(), 0.2);
}

// No robot is faster than some metres and half a turn a second.
TEST(Expect, TakesNoStepThatNoRobotMakes) {
  for (const Pose& jump : {Pose{10, 0, 0}, Pose{0, -10, 0}, Pose{0, 0, 3}}) {
    const Expectation expectation = expected(robot_at({1, 2, 0.5}), jump, 0.1);
    EXPECT_FALSE(expectation.plausible);
    expect_near(expectation.step, {});
    expect_near(expectation.claimed_step, jump);
    expect_near(expectation.local_from_robot, {1, 2, 0.5});
    EXPECT_GT(expectation.tracking_covariance(0, 0), 0.1) << "only matching can tell where it is";
    EXPECT_GT(expectation.tracking_covariance(2, 2), 0.05);
  }
  EXPECT_TRUE(expected(robot_at({}), {10, 0, 0}, 10).plausible) << "in ten seconds it does";
  EXPECT_TRUE(expected(robot_at({}), {0, 0, 3}, 10).plausible);
}

TEST(Expect, DoubtsOdometryThatIsBackAtItsOrigin) {
  EXPECT_FALSE(expected(robot_at({}, {0.8, 0, 0}), {0, 0, 0}, 10).plausible) << "switched off and on";
  EXPECT_TRUE(expected(robot_at({}, {0.8, 0, 0}), {0.2, 0, 0}, 10).plausible);
  EXPECT_TRUE(expected(robot_at({}, {0.3, 0, 0}), {0, 0, 0}, 10).plausible) << "it may have driven there";
}

}  // namespace
}  // namespace isthmus
