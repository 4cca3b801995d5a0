#include "server/wire/watch/robot_monitor.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(RobotMonitor, CountsClosuresAndSightingsByWhatBecameOfThem) {
  MapCopy map;
  using enum ClosureState;
  for (const ClosureState state : {accepted, refused, accepted, waiting, withdrawn, refused, refused})
    map.closures.emplace_back().state = state;
  for (const Verdict verdict : {Verdict::waiting, Verdict::accepted, Verdict::refused, Verdict::waiting,
                                Verdict::waiting, Verdict::refused, Verdict::waiting})
    map.sightings.append({{}, verdict, Reason::none, {}});
  map.counters.sightings = 7;
  const status_t status = RobotMonitor().status(map, {}, 5, 1);
  EXPECT_EQ(status.closures, 2);
  EXPECT_EQ(status.closures_refused, 3);
  EXPECT_EQ(status.closures_waiting, 1);
  EXPECT_EQ(status.closures_withdrawn, 1);
  EXPECT_EQ(status.sightings, 7);
  EXPECT_EQ(status.sightings_accepted, 1);
  EXPECT_EQ(status.sightings_refused, 2);
  EXPECT_EQ(status.sightings_waiting, 4);
}

TEST(RobotMonitor, TellsOfEachRobotWhatWasHeardAndDropped) {
  RobotMonitor monitor;
  monitor.heard("R1", 40);
  monitor.heard("", 50);
  RobotPose pose;
  pose.robot = "R1";
  for (const bool matched : {true, false, true, true}) {
    pose.matched = matched;
    monitor.answered(pose);
  }
  MapCopy map;
  map.counters.dropped_by_robot["R1"] = {{DropReason::stale_stamp, 2}};
  map.counters.dropped_by_robot["(others)"] = {{DropReason::unknown_robot, 9}};
  const status_t status = monitor.status(map, {3, 100, 1}, 60, 2);
  EXPECT_EQ(status.queued, 3);
  EXPECT_EQ(status.journal_bytes, 100);
  EXPECT_EQ(status.journal_failures, 1);
  ASSERT_EQ(status.nrobots, 2);
  const robot_status_t& others = status.robots[0];
  EXPECT_EQ(others.robot, "(others)");
  EXPECT_EQ(others.last_heard_utime, 0);
  ASSERT_EQ(others.ndropped, 1);
  EXPECT_EQ(others.dropped[0].count, 9);
  const robot_status_t& robot = status.robots[1];
  EXPECT_EQ(robot.robot, "R1");
  EXPECT_EQ(robot.last_heard_utime, 40);
  EXPECT_EQ(robot.share_matched, 0.75);
  EXPECT_GT(robot.scan_rate_hz, 0);
  ASSERT_EQ(robot.ndropped, 1);
  EXPECT_EQ(robot.dropped[0].count, 2);
}

}  // namespace
}  // namespace isthmus
