#include <numbers>

#include "tests/scenario/event_sequences.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

// What the report says of robots whose data is wrong. The map may be poor; it must not crash or grow without
// bound.

namespace isthmus {
namespace {

std::vector<std::string> keys_of(const MapCopy& map, const std::string& robot) {
  std::vector<std::string> keys;
  for (const HealthRecord& record : map.health) {
    if (record.robot != robot) continue;
    for (const HealthWarning& warning : record.warnings) {
      keys.push_back(warning.key);
      std::printf("%s: %s\n", warning.key.c_str(), warning.text.c_str());
    }
  }
  return keys;
}

bool is_among(const std::string& key, const std::vector<std::string>& keys) {
  return std::ranges::find(keys, key) != keys.end();
}

MapCopy map_with(const std::vector<std::string>& overrides, const std::string& scenario = "loop") {
  return map_scenario(scenario, overrides).map;
}

// The loop's events, their odometry changed.
template <class Change>
MapCopy map_with_odometry(Change change) {
  Events events = simulate(load_scenario("loop"), 1).events;
  for (Event& event : events)
    if (auto* odometry = std::get_if<OdometryEvent>(&event.body))
      odometry->odom_from_robot = change(odometry->odom_from_robot);
  return map_events(events);
}

using Keys = std::vector<std::string>;

TEST(Health, HealthyRobotsAreNotWarnedOf) {
  for (const char* scenario : {"loop", "hall", "corridor", "kidnap", "hard", "meeting", "repeated_rooms",
                               "long_corridors", "two_wings_pair", "hospital", "tags"}) {
    const MapCopy map = map_with({}, scenario);
    EXPECT_FALSE(map.health.empty());
    for (const HealthRecord& record : map.health)
      EXPECT_EQ(keys_of(map, record.robot), Keys{}) << scenario << " " << record.robot;
  }
}

TEST(Health, NoReturnsAtAll) {
  const MapCopy map = map_with({"laser.no_return_share=1"});
  EXPECT_EQ(keys_of(map, "R1"), Keys{"no_returns"});
  EXPECT_LT(map.patches.size(), 20U);
}

TEST(Health, OneBeam) {
  const MapCopy map = map_with({"laser.beams=1"});
  EXPECT_EQ(keys_of(map, "R1"), Keys{"few_beams"});
  EXPECT_LT(map.patches.size(), 20U);
}

TEST(Health, LaserMountedBackwards) {
  const MapCopy map = map_with({"laser.mount_error=[0, 0, 180]"}, "hall");
  EXPECT_EQ(keys_of(map, "R1"), Keys{"mount_backwards"});
  EXPECT_LT(map.patches.size(), map.counters.scans / 4U);
}

// All beams in the other order.
TEST(Health, LaserMountedUpsideDown) {
  Events events = simulate(load_scenario("hall"), 1).events;
  for (Event& event : events)
    if (auto* scan = std::get_if<ScanEvent>(&event.body)) std::ranges::reverse(scan->scan.ranges_m);
  EXPECT_EQ(keys_of(map_events(events), "R1"), Keys{"mount_mirrored"});
}

TEST(Health, OdometryStuckAtZero) {
  const MapCopy map = map_with_odometry([](const Pose&) { return Pose{}; });
  EXPECT_EQ(keys_of(map, "R1"), Keys{"odometry_still"});
}

TEST(Health, OdometryThatFreezes) {
  EXPECT_EQ(keys_of(map_with({}, "freezing"), "R1"), Keys{"odometry_freezes"});
}

TEST(Health, OdometryInAnotherUnit) {
  for (const double unit : {1000.0, 100.0, 3.281, 0.001}) {
    const MapCopy map = map_with_odometry([&](const Pose& pose) {
      return Pose{unit * pose.x, unit * pose.y, pose.yaw};
    });
    EXPECT_TRUE(is_among("odometry_unit", keys_of(map, "R1"))) << unit;
    EXPECT_LT(map.patches.size(), map.counters.scans / 3U) << unit;
  }
}

TEST(Health, DegreesForRadiansAndTheOtherWayRound) {
  constexpr double unit = 180 / std::numbers::pi;
  for (const double factor : {unit, 1 / unit}) {
    const MapCopy map = map_with_odometry([&](const Pose& pose) {
      return Pose{pose.x, pose.y, wrap_angle(factor * pose.yaw)};
    });
    EXPECT_TRUE(is_among("turn_unit", keys_of(map, "R1"))) << factor;
  }
}

TEST(Health, OdometryOfAnotherTime) {
  Events events = simulate(load_scenario("hall"), 1).events;
  for (Event& event : events)
    if (auto* odometry = std::get_if<OdometryEvent>(&event.body)) odometry->utime += 600'000;
  const MapCopy map = map_events(events);
  EXPECT_TRUE(is_among("time_offset", keys_of(map, "R1")));
}

// R2's clock is an hour off: both are mapped, each on its own time; whom they saw when cannot be told.
TEST(Health, AClockAnHourOffIsToldAndMappedOnItsOwnTime) {
  for (const std::int64_t off_us : {3'600'000'000, -3'600'000'000}) {
    Events events = simulate(load_scenario("meeting"), 1).events;
    for (Event& event : events) {
      if (auto* odometry = std::get_if<OdometryEvent>(&event.body); odometry && odometry->robot == "R2")
        odometry->utime += off_us;
      if (auto* scan = std::get_if<ScanEvent>(&event.body); scan && scan->robot == "R2")
        scan->scan.utime += off_us;
      if (auto* sighting = std::get_if<SightingEvent>(&event.body); sighting && sighting->robot == "R2")
        sighting->utime += off_us;
    }
    const MapCopy map = map_events(events);
    EXPECT_EQ(keys_of(map, "R1"), Keys{});
    EXPECT_EQ(keys_of(map, "R2"), Keys{off_us > 0 ? "clock_ahead" : "clock_behind"});
    EXPECT_EQ(map.counters.scans, 2 * 298);
    EXPECT_GT(map.counters.scans_matched, 2 * 290);
    EXPECT_TRUE(map.counters.dropped.empty());
    for (const SightingRecord& record : map.sightings)
      EXPECT_EQ(record.verdict, Verdict::refused) << word(record.reason);
  }
}

}  // namespace
}  // namespace isthmus
