#include "tools/simulate/run/unicycle.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace isthmus {
namespace {

RobotPlan robot_with(std::vector<TourStep> tour) {
  RobotPlan robot;
  robot.name = "R1";
  robot.tour = std::move(tour);
  robot.drive.waypoint_jitter_m = 0;
  return robot;
}

TEST(Unicycle, ArrivesAtItsWaypoints) {
  const TruePath path = drive(robot_with({Waypoint{{5, 0}}, Waypoint{{5, 3}}}), 1);
  const Pose end = *path.at(path.end_s());
  EXPECT_NEAR(end.x, 5, 0.1);
  EXPECT_NEAR(end.y, 3, 0.1);
}

TEST(Unicycle, CutsASquareCornerButLittle) {
  const TruePath path = drive(robot_with({Waypoint{{5, 0}}, Waypoint{{5, 5}}}), 1);
  double nearest = 1e9;
  for (const Pose& pose : path.stretches()[0].world_from_robot) {
    nearest = std::min(nearest, std::hypot(pose.x - 5, pose.y));
  }
  EXPECT_LT(nearest, 0.3);
}

TEST(Unicycle, TurnsBackOnTheSpot) {
  const TruePath path = drive(robot_with({Waypoint{{5, 0}}, Waypoint{{0, 0}}}), 1);
  for (const Pose& pose : path.stretches()[0].world_from_robot) EXPECT_LT(std::abs(pose.y), 0.1);
  EXPECT_NEAR(path.at(path.end_s())->x, 0, 0.1);
}

TEST(Unicycle, TurnsOnTheSpotByTheAngleAskedFor) {
  const TruePath path = drive(robot_with({Waypoint{{5, 0}}, Turn{-7}}), 1);
  double turned = 0;
  const auto& poses = path.stretches()[0].world_from_robot;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    turned += wrap_angle(poses[i].yaw - poses[i - 1].yaw);
    EXPECT_TRUE(std::abs(poses[i].yaw) < 0.1 || std::abs(poses[i].x - 5) < 0.1);
  }
  EXPECT_NEAR(turned, -7, 0.1);
}

TEST(Unicycle, KeepsItsBoundsOnSpeedTurnRateAndSlip) {
  const RobotPlan robot =
      robot_with({Waypoint{{3, 0}}, Waypoint{{3, 2}}, Waypoint{{0, 0}}, Waypoint{{2, -2}}});
  const TruePath path = drive(robot, 1);
  const std::vector<Pose>& poses = path.stretches()[0].world_from_robot;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose moved = ominus(poses[i], poses[i - 1]);
    EXPECT_LE(std::abs(moved.yaw), robot.drive.turn_rate_rps * TruePath::step_s + 1e-9);
    EXPECT_LE(std::hypot(moved.x, moved.y), robot.drive.speed_mps * TruePath::step_s + 1e-9);
    EXPECT_GE(moved.x, -1e-9);                                        // it never drives backwards
    EXPECT_NEAR(moved.y, moved.x * std::tan(0.5 * moved.yaw), 1e-9);  // nor sideways
  }
}

TEST(Unicycle, WaitsAndIsNotThereBeforeItsStart) {
  RobotPlan robot = robot_with({Waypoint{{1, 0}}, Wait{20}});
  robot.start_s = 30;
  const TruePath path = drive(robot, 1);
  EXPECT_FALSE(path.at(29.9));
  EXPECT_TRUE(path.at(30));
  EXPECT_GT(path.end_s(), 52);
  EXPECT_EQ(path.at(path.end_s() + 100), path.at(path.end_s()));
}

TEST(Unicycle, IsGoneWhileItIsCarried) {
  const TruePath path =
      drive(robot_with({Waypoint{{1, 0}}, Carry{{9, 9, 1}, 12, true, false}, Waypoint{{9, 8}}}), 1);
  ASSERT_EQ(path.stretches().size(), 2U);
  const double put_down_s = path.stretches()[1].start_s;
  EXPECT_NEAR(put_down_s - path.stretches()[0].end_s(), 12, 0.1);
  EXPECT_FALSE(path.at(put_down_s - 6));
  EXPECT_EQ(*path.at(put_down_s), (Pose{9, 9, 1}));
  EXPECT_NEAR(path.at(path.end_s())->y, 8, 0.1);
}

TEST(Unicycle, LapsVaryWithinTheRoomThereIs) {
  RobotPlan robot = robot_with({Waypoint{{4, 0}}, Waypoint{{0, 0}}});
  robot.drive.waypoint_jitter_m = 0.2;
  const Pose one = *drive(robot, 1).at(6), other = *drive(robot, 2).at(6);
  EXPECT_NE(one, other);
  for (TourStep& step : robot.tour) std::get<Waypoint>(step).clearance_m = robot.radius_m;
  EXPECT_EQ(drive(robot, 1).at(6), drive(robot, 2).at(6));
}

TEST(Unicycle, InterpolatesBetweenItsSteps) {
  const TruePath path({{0, {{0, 0, 3.1}, {1, 0, -3.1}}, false, false}});
  EXPECT_NEAR(path.at(0.01)->x, 0.5, 1e-9);
  EXPECT_NEAR(std::abs(path.at(0.01)->yaw), std::numbers::pi, 1e-9);
}

}  // namespace
}  // namespace isthmus
