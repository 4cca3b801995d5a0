#include "tools/simulate/live/pilot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace isthmus {
namespace {

constexpr double tick_s = 0.05;

/// A pilot on wheels that do as they are told.
struct Wheels {
  Pilot pilot{DrivePlan{}, 0.22};
  Pose pose;
  double time_s = 0;

  void go(double seconds) {
    for (const double until_s = time_s + seconds; time_s < until_s; time_s += tick_s) {
      pilot.note_odometry(pose, time_s);
      const Motion motion = pilot.drive();
      pose = {pose.x + tick_s * motion.speed_mps * std::cos(pose.yaw),
              pose.y + tick_s * motion.speed_mps * std::sin(pose.yaw),
              wrap_angle(pose.yaw + tick_s * motion.turn_rate_rps)};
    }
  }
};

TEST(Pilot, DrivesAlongAPathAndTurnsToTheHeadingAtItsEnd) {
  Wheels robot;
  robot.go(0.1);
  robot.pilot.follow({{0, 0}, {3, 0}, {3, 2}}, 3.1);
  robot.go(25);
  EXPECT_TRUE(robot.pilot.has_arrived());
  EXPECT_NEAR((position(robot.pose) - Eigen::Vector2d(3, 2)).norm(), 0, 0.3);
  EXPECT_NEAR(wrap_angle(robot.pose.yaw - 3.1), 0, 0.35);
}

TEST(Pilot, KeepsToItsPathAtACorner) {
  Wheels robot;
  robot.go(0.1);
  robot.pilot.follow({{0, 0}, {3, 0}, {3, 3}}, std::nullopt);
  double cut_m = 0;  // how far inside the corner it came
  for (int i = 0; i < 200; ++i) {
    robot.go(0.1);
    if (robot.pose.y < 1) cut_m = std::max(cut_m, std::min(3 - robot.pose.x, robot.pose.y));
  }
  EXPECT_LT(cut_m, 0.15);
  EXPECT_TRUE(robot.pilot.has_arrived());
}

TEST(Pilot, APathMovesWithTheMapsFrame) {
  Wheels robot;
  robot.go(0.1);
  robot.pilot.follow({{10, 0}, {13, 0}}, 0);
  robot.pilot.localise({-10, 1, 0});
  robot.go(20);
  EXPECT_NEAR((position(robot.pose) - Eigen::Vector2d(3, 1)).norm(), 0, 0.3);
}

TEST(Pilot, MakingWayItGoesBackWhereItCameFromAndStands) {
  Wheels robot;
  robot.go(0.1);
  robot.pilot.follow({{0, 0}, {4, 0}}, 0);
  robot.go(6);
  const double far_m = robot.pose.x;
  ASSERT_GT(far_m, 2);
  robot.pilot.back_off(1, 3);
  EXPECT_TRUE(robot.pilot.is_backing_off());
  robot.go(9);
  EXPECT_NEAR(robot.pose.x, far_m - 1, 0.4);
  EXPECT_NEAR(robot.pose.y, 0, 0.2);
  EXPECT_FALSE(robot.pilot.has_arrived());
}

TEST(Pilot, BehindAWallItKnowsThatItDoesNotGetOn) {
  Wheels robot;
  robot.go(0.1);
  Scan scan;
  scan.bearing0_rad = -1.5;
  scan.bearing_step_rad = 3.0 / 180;
  for (int i = 0; i <= 180; ++i)
    scan.ranges_m.push_back(
        static_cast<float>(0.35 / std::cos(scan.bearing0_rad + i * scan.bearing_step_rad)));
  Laser laser;
  laser.range_max_m = 8;
  robot.pilot.note_scan(scan, laser);
  robot.pilot.follow({{0, 0}, {4, 0}}, 0);
  robot.go(8);
  EXPECT_LT(robot.pose.x, 0.1);
  EXPECT_GT(robot.pilot.stuck_s(), 6);
  robot.pilot.halt();
  robot.go(0.1);
  EXPECT_EQ(robot.pilot.stuck_s(), 0);
}

}  // namespace
}  // namespace isthmus
