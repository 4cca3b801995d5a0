#include "tools/simulate/run/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

template <class T>
std::vector<T> all(const SimulatedRun& run, const std::string& robot) {
  std::vector<T> found;
  for (const Event& event : run.events) {
    const T* body = std::get_if<T>(&event.body);
    if (body != nullptr && body->robot == robot) found.push_back(*body);
  }
  return found;
}

TEST(Simulation, EventsComeInOrderOfTime) {
  const Scenario scenario = load_scenario("office", {"duration_s=20"});
  std::int64_t before = scenario.start_utime;
  for (const Event& event : simulate(scenario, 1).events) {
    EXPECT_GE(event.receive_utime, before);
    before = event.receive_utime;
  }
  EXPECT_LT(before, scenario.start_utime + 20'000'000);
  EXPECT_GT(before, scenario.start_utime + 19'000'000);
}

TEST(Simulation, EachScanHasOdometryOfItsOwnStampBeforeIt) {
  std::map<std::string, std::int64_t> last_odometry;
  int scans = 0;
  for (const Event& event : simulate(load_scenario("office", {"duration_s=20"}), 1).events) {
    if (const auto* odometry = std::get_if<OdometryEvent>(&event.body)) {
      EXPECT_GT(odometry->utime, last_odometry[odometry->robot]);
      last_odometry[odometry->robot] = odometry->utime;
    } else if (const auto* scan = std::get_if<ScanEvent>(&event.body)) {
      EXPECT_EQ(last_odometry[scan->robot], scan->scan.utime);
      ++scans;
    }
  }
  EXPECT_NEAR(scans, 2 * 100 + 2 * 60, 4);
}

TEST(Simulation, LasersMeetTheBuildingAsItIsByThen) {
  Scenario scenario = load_scenario("meeting", {"duration_s=10"});
  scenario.changes.push_back({5, scenario.plan});
  for (Segment& segment : scenario.changes[0].plan.segments) segment.return_limit_rad = 0;
  const auto scans = all<ScanEvent>(simulate(scenario, 1), "R1");
  ASSERT_GT(scans.size(), 20U);
  for (const ScanEvent& scan : scans) {
    const bool later = scan.scan.utime > scenario.start_utime + 5'000'000;
    const auto returns = std::ranges::count_if(scan.scan.ranges_m,
                                               [](float range) { return range > 0 && std::isfinite(range); });
    EXPECT_EQ(returns < 20, later);
    EXPECT_EQ(returns > 100, !later);
  }
}

TEST(Simulation, RobotsTellOfThemselvesFirst) {
  std::set<std::string> known;
  int told = 0;
  for (const Event& event : simulate(load_scenario("office", {"duration_s=20"}), 1).events) {
    if (const auto* robot = std::get_if<RobotEvent>(&event.body)) {
      known.insert(robot->robot);
      ++told;
      EXPECT_GE(robot->barcode, 101);
      EXPECT_EQ(robot->laser.range_max_m, 8);
    } else if (const auto* odometry = std::get_if<OdometryEvent>(&event.body)) {
      EXPECT_TRUE(known.contains(odometry->robot));
    }
  }
  EXPECT_EQ(known.size(), 4U);
  EXPECT_GE(told, 2 * 4 + 2 * 3);
}

TEST(Simulation, TruthHasAPoseForEachScan) {
  const SimulatedRun run = simulate(load_scenario("hall"), 1);
  const auto scans = all<ScanEvent>(run, "R1");
  ASSERT_EQ(run.truth.at(0).poses.size(), scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) EXPECT_EQ(run.truth[0].poses[i].utime, scans[i].scan.utime);
}

// As in logs of some lasers: every other scan looks between the beams of the one before.
TEST(Simulation, InterlacedScansAlternateByHalfAStep) {
  const auto scans = all<ScanEvent>(simulate(load_scenario("loop", {"laser.interlaced=true"}), 1), "R1");
  for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
    const double aside = scans[i + 1].scan.bearing0_rad - scans[i].scan.bearing0_rad;
    EXPECT_NEAR(std::abs(aside), 0.5 * scans[i].scan.bearing_step_rad, 1e-12);
  }
}

// Others see them as bodies; they send nothing and are not seen by cameras.
TEST(Simulation, SilentOnesSendNothing) {
  const SimulatedRun run =
      simulate(load_scenario("meeting", {"robots.R2.silent=true", "laser.range_sigma_m=0"}), 1);
  EXPECT_EQ(run.truth.size(), 1U);
  EXPECT_TRUE(all<ScanEvent>(run, "R2").empty());
  EXPECT_TRUE(all<SightingEvent>(run, "R1").empty());
  const SimulatedRun alone = simulate(
      load_scenario("meeting", {"robots.R2.silent=true", "laser.range_sigma_m=0", "bodies_visible=false"}),
      1);
  const auto with = all<ScanEvent>(run, "R1"), without = all<ScanEvent>(alone, "R1");
  ASSERT_EQ(with.size(), without.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < with.size(); ++i)
    different += with[i].scan.ranges_m != without[i].scan.ranges_m ? 1 : 0;
  EXPECT_GT(different, 5U);
  EXPECT_LT(different, with.size() * 9 / 10);
}

TEST(Simulation, SeedsDiffer) {
  const Scenario scenario = load_scenario("hall");
  EXPECT_NE(all<ScanEvent>(simulate(scenario, 1), "R1")[20].scan.ranges_m,
            all<ScanEvent>(simulate(scenario, 2), "R1")[20].scan.ranges_m);
}

TEST(Simulation, ScanLagMakesTheScanOlderThanItsStamp) {
  const std::vector<std::string> quiet = {"drive.waypoint_jitter_m=0", "laser.scan_lag_s=0.4"};
  const SimulatedRun lagging = simulate(load_scenario("to_and_fro", quiet), 1);
  const SimulatedRun prompt = simulate(load_scenario("to_and_fro", {quiet[0]}), 1);
  const Pose now = prompt.truth[0].poses[50].world_from_robot,
             then = lagging.truth[0].poses[50].world_from_robot;
  EXPECT_NEAR(now.x - then.x, 0.2, 0.01);
}

TEST(Simulation, KidnappedRobotIsSilentThenStartsAtZero) {
  const SimulatedRun run = simulate(load_scenario("kidnap"), 1);
  const auto odometry = all<OdometryEvent>(run, "R1");
  std::size_t gaps = 0;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    if (odometry[i].utime - odometry[i - 1].utime < 15'000'000) continue;
    ++gaps;
    EXPECT_NEAR(odometry[i].odom_from_robot.x, 0, 0.05);
    EXPECT_GT(std::hypot(odometry[i - 1].odom_from_robot.x, odometry[i - 1].odom_from_robot.y), 5);
  }
  EXPECT_EQ(gaps, 1U);
  EXPECT_EQ(run.truth[0].poses.front().stretch, 0U);
  EXPECT_EQ(run.truth[0].poses.back().stretch, 1U);
}

TEST(Simulation, AnnouncedCarryIsToldOnce) {
  const Scenario scenario = [] {
    Scenario s = load_scenario("kidnap");
    for (TourStep& step : s.robots[0].tour) {
      if (auto* carry = std::get_if<Carry>(&step)) carry->announced = true;
    }
    return s;
  }();
  int restarts = 0;
  for (const RobotEvent& event : all<RobotEvent>(simulate(scenario, 1), "R1"))
    restarts += event.restarted ? 1 : 0;
  EXPECT_EQ(restarts, 1);
}

TEST(Simulation, FrozenOdometryRepeatsItselfThenJumps) {
  const Scenario scenario = load_scenario("freeze");
  const auto odometry = all<OdometryEvent>(simulate(scenario, 1), "R1");
  double jump = 0;
  std::size_t frozen = 0;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    const double time_s = static_cast<double>(odometry[i].utime - scenario.start_utime) * 1e-6;
    const Pose moved = ominus(odometry[i].odom_from_robot, odometry[i - 1].odom_from_robot);
    if (time_s > 10.1 && time_s < 13) frozen += moved == Pose{} ? 1 : 100;
    jump = std::max(jump, std::hypot(moved.x, moved.y));
  }
  EXPECT_GT(frozen, 50U);
  EXPECT_LT(frozen, 100U);
  EXPECT_GT(jump, 0.8);
}

TEST(Simulation, BodiesStandInTheWayOnlyWhereTheScenarioSaysSo) {
  const auto differing = [](const char* visible) {
    const SimulatedRun run = simulate(load_scenario("office", {"duration_s=20", visible}), 1);
    const auto scans = all<ScanEvent>(run, "R4");
    return scans.at(30).scan.ranges_m;
  };
  EXPECT_NE(differing("bodies_visible=true"), differing("bodies_visible=false"));
}

TEST(Simulation, FalseSightingsComeToTheirShareAndAreListed) {
  const SimulatedRun run = simulate(load_scenario("office", {"false_sightings=0.2"}), 1);
  std::vector<SightingEvent> sightings;
  for (const Event& event : run.events) {
    if (const auto* sighting = std::get_if<SightingEvent>(&event.body)) sightings.push_back(*sighting);
  }
  const double share =
      static_cast<double>(run.false_sightings.size()) / static_cast<double>(sightings.size());
  EXPECT_NEAR(share, 0.2, 0.05);
  std::set<std::string> kinds;
  for (const FalseSighting& one : run.false_sightings) {
    kinds.insert(one.kind);
    ASSERT_LE(one.row, sightings.size());
    EXPECT_EQ(sightings[one.row - 1].utime, one.reported.utime);
    EXPECT_EQ(sightings[one.row - 1].barcode, one.reported.barcode);
    EXPECT_EQ(one.truth.barcode < 0, one.kind == "phantom");
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"gross", "phantom", "wrong_id"}));
}

TEST(Simulation, SightingsAreTrueByDefault) {
  const Scenario scenario = load_scenario("office");
  const SimulatedRun run = simulate(scenario, 1);
  EXPECT_TRUE(run.false_sightings.empty());
  EXPECT_GT(all<SightingEvent>(run, "R1").size(), 20U);
}

TEST(Simulation, TagsAreDeclaredAndSeen) {
  const SimulatedRun run = simulate(load_scenario("tags"), 1);
  std::set<int> declared, seen;
  for (const Event& event : run.events) {
    if (const auto* tag = std::get_if<TagEvent>(&event.body)) declared.insert(tag->barcode);
    if (const auto* sighting = std::get_if<SightingEvent>(&event.body)) {
      if (sighting->barcode > 900) seen.insert(sighting->barcode);
    }
  }
  EXPECT_EQ(declared.size(), 6U);
  EXPECT_EQ(seen, declared);
}

TEST(Simulation, RobotThatRunsIntoAWallIsAnError) {
  Scenario scenario = load_scenario("hall");
  scenario.robots[0].tour = {Waypoint{{2, -3}}};
  EXPECT_THROW(simulate(scenario, 1), std::runtime_error);
}

}  // namespace
}  // namespace isthmus
