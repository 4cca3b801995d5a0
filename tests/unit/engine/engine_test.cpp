#include "server/engine/engine.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "server/engine/engine_state.hpp"
#include "server/engine/record/counters.hpp"
#include "server/engine/robot/session.hpp"
#include "tests/support/start_utime.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

Event at(std::int64_t utime, decltype(Event::body) body) { return {utime, std::move(body)}; }

Event robot(const std::string& name, int barcode = -1, bool restarted = false) {
  RobotEvent event;
  event.robot = name;
  event.utime = start_utime;
  event.barcode = barcode;
  event.laser = laser_of();
  event.restarted = restarted;
  return at(start_utime, event);
}

Event odometry(const std::string& name, std::int64_t utime, const Pose& pose) {
  return at(utime, OdometryEvent{name, utime, pose});
}

Event scan(const std::string& name, std::int64_t utime, const Pose& world_from_robot) {
  return at(utime, ScanEvent{name, scan_from(furnished_room(), world_from_robot, utime)});
}

// Drives a robot straight through the furnished room, at 5 Hz, and returns the last answer.
RobotPose drive(Engine& engine, const std::string& name, std::int64_t from_utime, int scans, double step_m) {
  RobotPose last;
  for (int i = 0; i < scans; ++i) {
    const std::int64_t utime = from_utime + i * 200'000;
    const Pose pose{-2 + i * step_m, -1, 0};
    engine.handle(odometry(name, utime, pose));
    const Outcome outcome = engine.handle(scan(name, utime, pose));
    EXPECT_EQ(outcome.drop_reason, DropReason::none);
    if (!outcome.poses.empty()) last = outcome.poses.back();
  }
  return last;
}

TEST(Engine, ARobotDrivingThroughARoomIsLocalisedOnOneIsland) {
  Engine engine;
  engine.handle(robot("R1"));
  const RobotPose last = drive(engine, "R1", start_utime, 20, 0.1);
  EXPECT_TRUE(last.matched);
  EXPECT_NEAR(last.map_from_robot.x, 1.9, 0.03);
  EXPECT_NEAR(last.map_from_robot.y, 0, 0.03);
  const MapCopy map = engine.copy();
  EXPECT_EQ(map.graph.islands().size(), 1U);
  EXPECT_EQ(map.counters.scans, 20);
  EXPECT_EQ(map.counters.scans_matched, 20);
  EXPECT_EQ(map.trajectory_rows, 20U);
}

// A cable hangs before its laser, and somebody touches it: that goes where the robot goes.
TEST(Engine, WhatEndsWithinARobotsOwnBodyIsNoPartOfItsMap) {
  Engine engine;
  Event declared = robot("R1");
  std::get<RobotEvent>(declared.body).footprint_radius_m = 0.4;
  engine.handle(declared);
  Walls with_cable = furnished_room();
  add_box(with_cable, -1.8, -1.1, -1.7, -0.9);
  engine.handle(odometry("R1", start_utime, {-2, -1, 0}));
  engine.handle(at(start_utime, ScanEvent{"R1", scan_from(with_cable, {-2, -1, 0}, start_utime)}));
  const MapCopy map = engine.copy();
  ASSERT_EQ(map.patches.size(), 1U);
  ASSERT_FALSE(map.patches.front()->points.empty());
  for (const ScanPoint& point : map.patches.front()->points) EXPECT_GT(point.position.norm(), 0.4);
}

// The old patches stay, new ones are refused, and the robot is still told where it is.
TEST(Engine, ARobotWithAllItsPatchesIsLocalisedAndAddsNoMore) {
  Configuration configuration;
  configuration.engine.patch_spacing_m = 0.3;
  configuration.engine.patches_per_robot = 2;
  Engine engine(configuration);
  engine.handle(robot("R1"));
  engine.handle(robot("R2"));
  const RobotPose last = drive(engine, "R1", start_utime, 20, 0.1);
  EXPECT_TRUE(last.matched);
  EXPECT_NEAR(last.map_from_robot.x, 1.9, 0.05);
  drive(engine, "R2", start_utime, 1, 0.1);
  const MapCopy map = engine.copy();
  EXPECT_EQ(map.patches.size(), 3U) << "each robot has its own limit";
  EXPECT_GT(map.counters.dropped_by_robot.at("R1").at(DropReason::too_many_patches), 0);
  EXPECT_FALSE(map.counters.dropped_by_robot.contains("R2"));
  EXPECT_EQ(map.trajectory_rows, 21U);
}

TEST(Engine, ARobotWithAllItsPatchesDoesNotBeginAgain) {
  Configuration configuration;
  configuration.engine.patches_per_robot = 1;
  Engine engine(configuration);
  engine.handle(robot("R1"));
  drive(engine, "R1", start_utime, 1, 0.1);
  engine.handle(robot("R1", -1, true));
  const std::int64_t later = start_utime + 1'000'000;
  engine.handle(odometry("R1", later, Pose{}));
  EXPECT_TRUE(engine.handle(scan("R1", later, Pose{-2, -1, 0})).poses.empty());
  const MapCopy map = engine.copy();
  EXPECT_EQ(map.patches.size(), 1U);
  EXPECT_EQ(map.counters.dropped.at(DropReason::too_many_patches), 1);
}

TEST(Engine, EveryRelationSaysWhereItCameFrom) {
  Engine engine;
  engine.handle(robot("R1"));
  drive(engine, "R1", start_utime, 20, 0.15);
  const MapCopy map = engine.copy();
  int odometry_relations = 0;
  for (const auto& [id, relation] : map.graph.relations()) {
    EXPECT_TRUE(relation.origin.kind == OriginKind::match || relation.origin.kind == OriginKind::odometry);
    if (relation.origin.kind == OriginKind::odometry) ++odometry_relations;
  }
  EXPECT_EQ(odometry_relations, static_cast<int>(map.patches.size()) - 1);
}

TEST(Engine, TwoRobotsMapTheirOwnIslands) {
  Engine engine;
  engine.handle(robot("R1", 1));
  engine.handle(robot("R2", 2));
  drive(engine, "R1", start_utime, 5, 0.1);
  drive(engine, "R2", start_utime + 10'000'000, 5, 0.1);
  EXPECT_EQ(engine.copy().graph.islands().size(), 2U);
}

TEST(Engine, AnUnknownRobotIsCountedAndNothingElseHappens) {
  Engine engine;
  EXPECT_EQ(engine.handle(odometry("R9", start_utime, {})).drop_reason, DropReason::unknown_robot);
  EXPECT_EQ(engine.handle(scan("R9", start_utime, {})).drop_reason, DropReason::unknown_robot);
  const MapCopy map = engine.copy();
  EXPECT_TRUE(map.patches.empty());
  EXPECT_EQ(map.counters.dropped.at(DropReason::unknown_robot), 2);
  EXPECT_EQ(map.counters.dropped_by_robot.at("(others)").at(DropReason::unknown_robot), 2);
}

TEST(Engine, AScanWithoutBeamsOrWithTheLastStampIsDroppedByReason) {
  Engine engine;
  engine.handle(robot("R1"));
  drive(engine, "R1", start_utime, 3, 0.1);
  const std::string before = map_sha256(engine.copy());
  ScanEvent empty{"R1", {}};
  empty.scan.utime = start_utime + 900'000;
  EXPECT_EQ(engine.handle(at(start_utime + 900'000, empty)).drop_reason, DropReason::zero_beams);
  EXPECT_EQ(engine.handle(scan("R1", start_utime + 400'000, {})).drop_reason, DropReason::duplicate_stamp);
  EXPECT_EQ(engine.handle(scan("R1", start_utime - 5'000'000, {})).drop_reason, DropReason::stale_stamp);
  EXPECT_EQ(map_sha256(engine.copy()), before);
}

TEST(Engine, AScanWaitsForItsOdometryAndNoLongerThanAFifthOfASecond) {
  Engine engine;
  engine.handle(robot("R1"));
  engine.handle(odometry("R1", start_utime, {}));
  EXPECT_TRUE(engine.handle(scan("R1", start_utime + 50'000, {})).poses.empty());
  EXPECT_EQ(engine.handle(odometry("R1", start_utime + 100'000, {})).poses.size(), 1U);
  EXPECT_TRUE(engine.handle(scan("R1", start_utime + 300'000, {})).poses.empty());
  EXPECT_EQ(engine.handle(at(start_utime + 600'000, TickEvent{})).poses.size(), 1U);
}

TEST(Engine, ARobotThatNeverSentOdometryIsAnsweredByACount) {
  Engine engine;
  engine.handle(robot("R1"));
  engine.handle(scan("R1", start_utime, {}));
  engine.finish();
  EXPECT_EQ(engine.copy().counters.dropped.at(DropReason::no_odometry), 1);
}

TEST(Engine, ARestartedRobotBeginsANewSessionOnANewIsland) {
  Engine engine;
  engine.handle(robot("R1"));
  drive(engine, "R1", start_utime, 5, 0.1);
  engine.handle(robot("R1", -1, true));
  drive(engine, "R1", start_utime + 10'000'000, 5, 0.1);
  const MapCopy map = engine.copy();
  EXPECT_EQ(map.sessions.size(), 2U);
  EXPECT_EQ(map.graph.islands().size(), 2U);
}

TEST(Engine, SightingsAreValidated) {
  Engine engine;
  engine.handle(robot("R1", 1));
  engine.handle(robot("R2", 2));
  engine.handle(at(start_utime, TagEvent{start_utime, 50}));
  const auto see = [&](const std::string& who, int barcode) {
    return engine.handle(at(start_utime, SightingEvent{who, start_utime, barcode, 2, 0.1, 0.5, 0.02}))
        .drop_reason;
  };
  EXPECT_EQ(see("R1", 2), DropReason::none);
  EXPECT_EQ(see("R1", 50), DropReason::none);
  EXPECT_EQ(see("R1", 1), DropReason::sees_itself);
  EXPECT_EQ(see("R1", 77), DropReason::unknown_barcode);
  EXPECT_EQ(see("R7", 1), DropReason::unknown_robot);
  const MapCopy map = engine.copy();
  ASSERT_EQ(map.sightings.size(), 5U);
  EXPECT_EQ(map.sightings[0].verdict, Verdict::waiting);
  EXPECT_EQ(map.sightings[2].verdict, Verdict::refused);
  EXPECT_EQ(map.sightings[2].reason, Reason::sees_itself);
}

// One stamp from the past is dropped and counted; a clock that was set back begins a new session.
TEST(Engine, ARobotWithoutALaserWhoseClockIsSetBackBeginsAnew) {
  Engine engine;
  RobotEvent blind;
  blind.robot = "R1";
  blind.laser.range_min_m = blind.laser.range_max_m = 0;
  engine.handle(at(start_utime, blind));
  const auto drive_at = [&](std::int64_t utime) {
    return engine.handle(at(utime, OdometryEvent{"R1", utime, Pose{}})).drop_reason;
  };
  EXPECT_EQ(drive_at(start_utime), DropReason::none);
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ(drive_at(start_utime - 60'000'000 + i * 100'000), DropReason::stale_stamp);
  EXPECT_EQ(engine.copy().sessions.size(), 1U);
  EXPECT_EQ(drive_at(start_utime - 59'000'000), DropReason::none);
  EXPECT_EQ(engine.copy().sessions.size(), 2U);
}

TEST(Engine, TwoRobotsCannotWearOneBarcode) {
  Engine engine;
  engine.handle(robot("R1", 1));
  EXPECT_EQ(engine.handle(robot("R2", 1)).drop_reason, DropReason::barcode_taken);
  EXPECT_EQ(engine.handle(robot("R2", 2)).drop_reason, DropReason::none);
}

TEST(Engine, AConfigurationIsTakenOnlyFirst) {
  Engine engine;
  EXPECT_EQ(engine.handle(at(start_utime, ConfigurationEvent{"tags = \"any\""})).drop_reason,
            DropReason::none);
  EXPECT_TRUE(engine.configuration().any_tag);
  EXPECT_EQ(engine.handle(at(start_utime, ConfigurationEvent{""})).drop_reason,
            DropReason::late_configuration);
  EXPECT_TRUE(engine.configuration().any_tag);
}

TEST(Engine, TheSameEventsGiveTheSameMapToTheByte) {
  const auto run = [] {
    Engine engine;
    engine.handle(robot("R1"));
    drive(engine, "R1", start_utime, 25, 0.12);
    engine.finish();
    return map_sha256(engine.copy());
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace isthmus
