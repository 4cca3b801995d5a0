// A robot may say anew what it is at any time: what was heard before is read as it was said before.

#include <gtest/gtest.h>

#include "server/engine/engine.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/start_utime.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr std::int64_t period_us = 200'000;

RobotEvent with_laser(double range_max_m) {
  RobotEvent event;
  event.robot = "R1";
  event.utime = start_utime;
  event.laser = laser_of(range_max_m);
  return event;
}

RobotEvent without_laser() {
  RobotEvent event = with_laser(0);
  event.laser.range_min_m = 0;
  return event;
}

// A robot that drives along x through the furnished room at 0.5 m/s and sends at 5 Hz; times are of its own.
class Declared {
 public:
  Outcome say(const RobotEvent& event) { return engine.handle({utime_, event}); }
  Outcome tell_odometry() { return engine.handle({utime_, OdometryEvent{"R1", utime_, odometry()}}); }
  Outcome tell_scan(std::int64_t ahead_us = 0) {
    return engine.handle(
        {utime_, ScanEvent{"R1", scan_from(furnished_room(), world_from_robot(), utime_ + ahead_us)}});
  }
  void pass() { utime_ += period_us; }
  void drive(int periods) {
    for (int i = 0; i < periods; ++i) {
      tell_odometry();
      tell_scan();
      pass();
    }
  }
  void drive_blind(int periods) {
    for (int i = 0; i < periods; ++i) {
      tell_odometry();
      pass();
    }
  }
  double way_m() const { return 0.1 * static_cast<double>((utime_ - start_utime) / period_us); }
  Pose odometry() const { return {way_m(), 0, 0}; }
  Pose world_from_robot() const { return {-3 + way_m(), -1, 0}; }
  std::int64_t dropped(DropReason reason) const {
    const Counters counters = engine.copy().counters;
    const auto found = counters.dropped.find(reason);
    return found == counters.dropped.end() ? 0 : found->second;
  }
  /// Of the last row of the trajectory, on the map.
  Pose last_place() const {
    const MapCopy map = engine.copy();
    const TrajectoryRow row = map.trajectory->read(map.trajectory_rows - 1, 1).front();
    return map.poses[static_cast<std::size_t>(row.patch.value)] * row.patch_from_robot;
  }

  Engine engine;

 private:
  std::int64_t utime_ = start_utime;
};

TEST(Declaration, ARobotWhoseLaserGoesOffGoesOnWhereItsScansHadPutIt) {
  Declared robot;
  robot.say(with_laser(20));
  robot.drive(15);
  const std::size_t mapped = robot.engine.copy().patches.size();
  robot.say(without_laser());
  EXPECT_EQ(robot.engine.copy().patches.size(), mapped);
  robot.drive_blind(30);
  robot.engine.finish();
  const MapCopy map = robot.engine.copy();
  EXPECT_GT(map.patches.size(), mapped + 1) << "it makes patches of its way from now on";
  EXPECT_EQ(map.graph.islands().size(), 1U) << "tied to those of its scans";
  EXPECT_EQ(map.sessions.size(), 1U);
  EXPECT_NEAR(robot.last_place().x, robot.way_m() - 0.1, 0.05);
  EXPECT_NEAR(robot.last_place().y, 0, 0.05);
  for (std::size_t i = mapped; i < map.patches.size(); ++i) {
    EXPECT_TRUE(map.patches[i]->points.empty());
    EXPECT_LT(area_m2(map.patches[i]->free_space), 2)
        << "what it swept, not the way since its last scan's patch";
  }
}

TEST(Declaration, ARobotWhoseLaserComesOnIsMappedOnFromItsFootprints) {
  Declared robot;
  robot.say(without_laser());
  robot.drive_blind(10);
  robot.say(with_laser(20));
  robot.drive(40);
  robot.engine.finish();
  const MapCopy map = robot.engine.copy();
  EXPECT_EQ(map.graph.islands().size(), 1U);
  EXPECT_EQ(map.counters.scans, 40);
  EXPECT_GT(map.counters.scans_matched, 20);
  EXPECT_NEAR(robot.last_place().x, robot.way_m() - 0.1, 0.1);
}

TEST(Declaration, ALaserThatGoesOnAndOffLeavesOneIsland) {
  Declared robot;
  for (int i = 0; i < 6; ++i) {
    robot.say(i % 2 == 0 ? with_laser(20) : without_laser());
    robot.drive(6);
  }
  robot.engine.finish();
  EXPECT_EQ(robot.engine.copy().graph.islands().size(), 1U);
  EXPECT_EQ(robot.dropped(DropReason::no_laser), 18);
}

TEST(Declaration, ScansOfARobotWithoutALaserAreRefused) {
  Declared robot;
  robot.say(without_laser());
  EXPECT_EQ(robot.tell_scan().drop_reason, DropReason::no_laser);
  robot.pass();
  robot.tell_odometry();
  const MapCopy map = robot.engine.copy();
  EXPECT_EQ(map.patches.size(), 1U);
  EXPECT_EQ(map.counters.scans, 0);
}

// In doubt where it is, it begins an island of its own rather than go on from there.
TEST(Declaration, ARobotInDoubtWhoseLaserGoesOffBeginsAnew) {
  Declared robot;
  robot.say(with_laser(20));
  robot.drive(5);
  // Its odometry jumps, and what it sees next is nothing.
  for (int i = 0; i < 2; ++i) {
    const std::int64_t utime = start_utime + (5 + i) * period_us;
    robot.engine.handle({utime, OdometryEvent{"R1", utime, {40, 30, 2}}});
    robot.engine.handle({utime, ScanEvent{"R1", scan_from(Walls{}, {}, utime)}});
    robot.pass();
  }
  robot.say(without_laser());
  const std::int64_t utime = start_utime + 8 * period_us;
  const Outcome outcome = robot.engine.handle({utime, OdometryEvent{"R1", utime, {40, 30, 2}}});
  ASSERT_EQ(outcome.poses.size(), 1U);
  EXPECT_EQ(robot.engine.copy().graph.islands().size(), 2U);
  EXPECT_EQ(robot.engine.copy().sessions.size(), 2U);
}

TEST(Declaration, AScanThatWaitsIsReadAsTheLaserWasWhenItCame) {
  Declared robot;
  robot.say(with_laser(20));
  robot.drive(3);
  robot.tell_odometry();
  EXPECT_TRUE(robot.tell_scan(50'000).poses.empty()) << "it waits for its odometry";
  RobotEvent turned = with_laser(20);
  turned.laser.robot_from_laser = {0, 0, 1};
  const Outcome outcome = robot.say(turned);
  ASSERT_EQ(outcome.poses.size(), 1U);
  EXPECT_TRUE(outcome.poses[0].matched);
  EXPECT_NEAR(outcome.poses[0].map_from_robot.yaw, 0, 0.02);
}

TEST(Declaration, AScanThatWaitsIsNotHurriedByTheSameDeclarationOnceMore) {
  Declared robot;
  robot.say(with_laser(20));
  robot.drive(3);
  robot.tell_odometry();
  robot.tell_scan(50'000);
  EXPECT_TRUE(robot.say(with_laser(20)).poses.empty());
  RobotEvent other = with_laser(20);
  other.barcode = 7;
  other.footprint_radius_m = 0.4;
  EXPECT_TRUE(robot.say(other).poses.empty());
}

// The same room through a laser that sits elsewhere: told so, the map does not move.
TEST(Declaration, AnotherMountIsOfTheScansFromThenOn) {
  Declared robot;
  robot.say(with_laser(20));
  robot.drive(10);
  RobotEvent moved = with_laser(20);
  moved.laser.robot_from_laser = {0.2, 0.1, 0.5};
  robot.say(moved);
  for (int i = 0; i < 10; ++i) {
    robot.tell_odometry();
    const std::int64_t utime = start_utime + (10 + i) * period_us;
    const Pose world_from_laser = robot.world_from_robot() * moved.laser.robot_from_laser;
    const Outcome outcome =
        robot.engine.handle({utime, ScanEvent{"R1", scan_from(furnished_room(), world_from_laser, utime)}});
    ASSERT_EQ(outcome.poses.size(), 1U);
    EXPECT_TRUE(outcome.poses[0].matched);
    EXPECT_NEAR(outcome.poses[0].map_from_robot.x, robot.way_m(), 0.03);
    EXPECT_NEAR(outcome.poses[0].map_from_robot.y, 0, 0.03);
    robot.pass();
  }
}

TEST(Declaration, AnotherRangeIsOfTheScansFromThenOn) {
  Declared robot;
  robot.say(with_laser(20));
  robot.drive(10);
  robot.say(with_laser(0.1));  // every beam is now one without a return
  robot.drive(1);
  EXPECT_EQ(robot.engine.copy().counters.scans_predicted.at(Unmatched::few_returns), 1);
  robot.say(with_laser(20));
  robot.drive(10);
  const MapCopy map = robot.engine.copy();
  EXPECT_EQ(map.counters.scans_matched, 20);
  EXPECT_EQ(map.graph.islands().size(), 1U);
}

TEST(Declaration, ABarcodeIsOfWhoeverWearsItWhenItIsSeen) {
  Declared robot;
  robot.say(with_laser(20));
  RobotEvent other = with_laser(20);
  other.robot = "R2";
  other.barcode = 5;
  robot.say(other);
  const auto see = [&](int barcode) {
    return robot.engine.handle({start_utime, SightingEvent{"R1", start_utime, barcode, 2, 0.1, 0, 0.02}})
        .drop_reason;
  };
  EXPECT_EQ(see(5), DropReason::none);
  other.barcode = 6;
  robot.say(other);
  EXPECT_EQ(see(5), DropReason::unknown_barcode);
  EXPECT_EQ(see(6), DropReason::none);
  RobotEvent own = with_laser(20);
  own.barcode = 5;  // free again
  EXPECT_EQ(robot.say(own).drop_reason, DropReason::none);
  EXPECT_EQ(see(5), DropReason::sees_itself);
}

TEST(Declaration, WhatWaitsWhenARobotRestartsIsCounted) {
  Declared robot;
  robot.say(with_laser(20));
  robot.drive(3);
  robot.tell_odometry();
  robot.tell_scan(50'000);
  robot.tell_scan(60'000);
  RobotEvent again = with_laser(20);
  again.restarted = true;
  robot.say(again);
  EXPECT_EQ(robot.dropped(DropReason::restarted), 2);
}

TEST(Declaration, ScansThatWaitAreBoundedWhereTimeStandsStill) {
  Declared robot;
  robot.say(with_laser(20));
  for (int i = 0; i < 1000; ++i) robot.tell_scan(i);  // without any odometry, in no time
  EXPECT_EQ(robot.dropped(DropReason::no_odometry), 1000 - 64);
  robot.engine.finish();
  EXPECT_EQ(robot.dropped(DropReason::no_odometry), 1000);
}

}  // namespace
}  // namespace isthmus
