#include "tools/simulate/wild/wheel_faults.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/start_utime.hpp"

namespace isthmus {
namespace {

using testing::simulated_start_utime;

constexpr std::int64_t step_us = 50'000;

// 2 s at 0.5 m/s, 2 s of turning on the spot at 1.5 rad/s, 2 s at 0.5 m/s, with a scan at every fifth
// reading.
SimulatedRun a_turn() {
  SimulatedRun run;
  run.truth = {{"R1", {}}};
  Pose pose;
  for (int i = 0; i <= 120; ++i) {
    const std::int64_t utime = simulated_start_utime + i * step_us;
    if (i > 0) pose = pose * (i > 40 && i <= 80 ? Pose{0, 0, 0.075} : Pose{0.025, 0, 0});
    run.events.push_back({utime, OdometryEvent{"R1", utime, pose}});
    if (i % 5 != 0) continue;
    ScanEvent scan{"R1", {}};
    scan.scan.utime = utime;
    run.events.push_back({utime, scan});
    run.truth[0].poses.push_back({utime, 0, pose});
  }
  return run;
}

std::vector<Pose> odometry(const SimulatedRun& run) {
  std::vector<Pose> poses;
  for (const Event& event : run.events)
    if (const auto* odometry = std::get_if<OdometryEvent>(&event.body))
      poses.push_back(odometry->odom_from_robot);
  return poses;
}

std::vector<Pose> spoilt(const WheelFaults& faults) {
  SimulatedRun run = a_turn();
  spoil_wheels(run, "R1", faults, 1);
  return odometry(run);
}

TEST(WheelFaults, NoneChangeNothing) {
  const std::vector<Pose> before = odometry(a_turn()), after = spoilt({});
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_LT(wrapped_difference(before[i], after[i]).norm(), 1e-9) << i;
}

TEST(WheelFaults, WheelsThatSlipLoseOrAddAShareOfTheTurnForGood) {
  WheelFaults faults;
  faults.slip_chance = 1;
  faults.slip_share = 0.4;
  const std::vector<Pose> after = spoilt(faults);
  const double lost = wrap_angle(after.back().yaw - 3.0);
  EXPECT_LE(std::abs(lost), 0.4 * 3.0 + 1e-9);
  EXPECT_GT(std::abs(lost), 0.01);
  EXPECT_NEAR(after[40].yaw, 0, 1e-9);
  EXPECT_NEAR(after.back().yaw, after[80].yaw, 1e-9);
}

TEST(WheelFaults, AFastTurnIsToldLaterAndInFull) {
  WheelFaults faults;
  faults.told_rps = 1;
  const std::vector<Pose> after = spoilt(faults);
  for (std::size_t i = 1; i < after.size(); ++i)
    EXPECT_LE(std::abs(wrap_angle(after[i].yaw - after[i - 1].yaw)), 0.05 + 1e-6);
  EXPECT_NEAR(after[80].yaw, 2, 1e-3);
  EXPECT_NEAR(after.back().yaw, 3, 1e-3);
}

TEST(WheelFaults, AFreezeInATurnRepeatsAndThenJumpsToWhereItShouldBe) {
  WheelFaults faults;
  faults.freeze_chance = 1;
  faults.freeze_s = 1.5;
  const std::vector<Pose> before = odometry(a_turn()), after = spoilt(faults);
  int repeated = 0;
  for (std::size_t i = 41; i < 81; ++i) repeated += after[i] == after[i - 1] ? 1 : 0;
  EXPECT_GE(repeated, 5);
  EXPECT_LE(repeated, 30);
  EXPECT_LT(wrapped_difference(before.back(), after.back()).norm(), 1e-9);
}

TEST(WheelFaults, AJumpTurnsTheWayThatFollows) {
  WheelFaults faults;
  faults.jumps_per_min = 60;
  faults.jump_rad = 0.5;
  const std::vector<Pose> before = odometry(a_turn()), after = spoilt(faults);
  EXPECT_GT(std::abs(wrap_angle(before.back().yaw - after.back().yaw)), 0.01);
  for (std::size_t i = 1; i < after.size(); ++i) {
    const Eigen::Vector2d moved = position(ominus(after[i], after[i - 1]));
    EXPECT_NEAR(moved.norm(), i > 40 && i <= 80 ? 0 : 0.025, 1e-9);
  }
}

TEST(WheelFaults, OdometryThatLagsTellsOfTheTimeBefore) {
  WheelFaults faults;
  faults.lag_s = 0.1;
  const std::vector<Pose> before = odometry(a_turn()), after = spoilt(faults);
  for (std::size_t i = 3; i < after.size(); ++i)
    EXPECT_LT(wrapped_difference(before[i - 2], after[i]).norm(), 1e-5) << i;
}

TEST(WheelFaults, StampsThatJitterAreThoseOfScanOdometryAndTruthAlike) {
  WheelFaults faults;
  faults.jitter_s = 0.01;
  SimulatedRun run = a_turn();
  spoil_wheels(run, "R1", faults, 1);
  std::int64_t odometry_utime = 0;
  std::size_t scans = 0, moved = 0;
  for (const Event& event : run.events) {
    if (const auto* odometry = std::get_if<OdometryEvent>(&event.body)) {
      odometry_utime = odometry->utime;
      EXPECT_LE(std::abs(odometry_utime - event.receive_utime), 10'000);
      moved += odometry_utime != event.receive_utime ? 1U : 0U;
    } else if (const auto* scan = std::get_if<ScanEvent>(&event.body)) {
      EXPECT_EQ(scan->scan.utime, odometry_utime);
      EXPECT_EQ(run.truth[0].poses.at(scans++).utime, odometry_utime);
    }
  }
  EXPECT_GT(moved, 100U);
}

TEST(WheelFaults, AnotherRobotIsLeftAlone) {
  WheelFaults faults;
  faults.slip_chance = faults.slip_share = 1;
  faults.jitter_s = 0.01;
  SimulatedRun run = a_turn();
  spoil_wheels(run, "R2", faults, 1);
  EXPECT_EQ(odometry(run), odometry(a_turn()));
}

}  // namespace
}  // namespace isthmus
