#include "server/engine/robot/scan_delay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace isthmus {
namespace {

constexpr std::int64_t scan_us = 200'000;

// A robot that turns to and fro, whose scans are stamped late by so much.
struct TurningRobot {
  explicit TurningRobot(double late_s, double radius = 1) : delay_s(late_s), radius_rad(radius) {}

  double delay_s;
  double radius_rad;
  bool scans_slip = false;  ///< odometry of one turn in ten is off by a radian
  OdometryTrack odometry;
  ScanDelay delay;
  double slipped_rad = 0;

  static double yaw_at(double seconds) { return std::sin(0.7 * seconds) + 0.4 * std::sin(1.9 * seconds); }
  void drive(int first, int scans) {
    for (int i = first; i < first + scans; ++i) {
      for (int k = 0; k < 4; ++k) {
        const std::int64_t utime = scan_us * i + 50'000 * k;
        odometry.add(utime, {0, 0, radius_rad * yaw_at(1e-6 * static_cast<double>(utime)) + slipped_rad});
      }
      if (scans_slip && i % 10 == 3) slipped_rad += 1;
      const double now_s = 1e-6 * static_cast<double>(scan_us * i) - delay_s;
      const double turn_rad = radius_rad * (yaw_at(now_s) - yaw_at(now_s - 1e-6 * scan_us));
      delay.learn({scan_us * (i - 1), scan_us * i, turn_rad, 1e-5}, odometry, {}, {});
    }
  }
  double learned_s() const { return 1e-6 * static_cast<double>(delay.us()); }
};

TEST(ScanDelay, IsNoneBeforeAnythingIsLearned) { EXPECT_EQ(ScanDelay().us(), 0); }

TEST(ScanDelay, IsNotLearnedWithoutOdometry) {
  ScanDelay delay;
  for (int i = 1; i < 10; ++i)
    delay.learn({scan_us * (i - 1), scan_us * i, 0.3, 1e-5}, OdometryTrack{}, {}, {});
  EXPECT_EQ(delay.us(), 0);
  EXPECT_TRUE(std::get<1>(delay.members()).empty());
}

TEST(ScanDelay, IsLearnedFromTurns) {
  for (const double delay_s : {-0.33, -0.04, 0.12, 0.64}) {
    TurningRobot robot(delay_s);
    robot.drive(0, 100);
    EXPECT_NEAR(robot.learned_s(), delay_s, 0.015);
  }
}

TEST(ScanDelay, IsLearnedAmongSlips) {
  TurningRobot robot(0.12);
  robot.scans_slip = true;
  robot.drive(0, 100);
  EXPECT_NEAR(robot.learned_s(), 0.12, 0.03);
}

TEST(ScanDelay, IsTakenToBeNoneOfARobotThatDoesNotTurn) {
  TurningRobot robot(0.5, 0);
  robot.drive(0, 100);
  EXPECT_EQ(robot.delay.us(), 0);
}

TEST(ScanDelay, IsNoneUntilOneIsMoreProbable) {
  TurningRobot exact(0);
  exact.drive(0, 300);
  EXPECT_EQ(exact.delay.us(), 0) << "not some microseconds";
  TurningRobot robot(0.3, 0.02);
  robot.drive(0, 18);
  EXPECT_EQ(robot.delay.us(), 0) << "turns of some milliradians tell little";
  robot.drive(18, 182);
  EXPECT_NEAR(robot.learned_s(), 0.3, 0.1);
}

TEST(ScanDelay, FollowsADriverThatWasRestarted) {
  TurningRobot robot(0.12);
  robot.drive(0, 1500);
  robot.delay_s = 0.5;
  robot.drive(1500, 1000);
  EXPECT_NEAR(robot.learned_s(), 0.5, 0.03);
}

TEST(ScanDelay, KeepsNoMoreTurnsThanMayYetBeWeighed) {
  TurningRobot robot(0.12);
  robot.drive(0, 100);
  const std::int64_t before = robot.delay.us();
  for (int i = 100; i < 1000; ++i)
    robot.delay.learn({scan_us * (i - 1), scan_us * i, 0.3, 1e-5}, robot.odometry, {}, {});
  EXPECT_LE(std::get<1>(robot.delay.members()).size(), 11U) << "of two seconds: no odometry came any more";
  EXPECT_EQ(robot.delay.us(), before);
}

}  // namespace
}  // namespace isthmus
