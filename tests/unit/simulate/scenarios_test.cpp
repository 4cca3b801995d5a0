#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tools/simulate/run/simulation.hpp"
#include "tools/simulate/run/unicycle.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

double seconds_of(const Scenario& scenario, std::int64_t utime) {
  return static_cast<double>(utime - scenario.start_utime) * 1e-6;
}

// Times at which any robot reads another's barcode; readings at most 10 s apart are one meeting.
std::vector<double> beginnings_of_meetings(const Scenario& scenario, const SimulatedRun& run) {
  std::vector<double> beginnings;
  double last_s = -1e9;
  for (const Event& event : run.events) {
    const auto* sighting = std::get_if<SightingEvent>(&event.body);
    if (sighting == nullptr || sighting->barcode > 900) continue;
    const double time_s = seconds_of(scenario, sighting->utime);
    if (time_s - last_s > 10) beginnings.push_back(time_s);
    last_s = time_s;
  }
  return beginnings;
}

std::vector<TruePath> paths_of(const Scenario& scenario, std::uint64_t seed) {
  std::vector<TruePath> paths;
  for (const RobotPlan& robot : scenario.robots) paths.push_back(drive(robot, seed));
  return paths;
}

double min_distance_m(const Scenario& scenario, std::uint64_t seed) {
  const std::vector<TruePath> paths = paths_of(scenario, seed);
  double end_s = 0, least = 1e9;
  for (const TruePath& path : paths) end_s = std::max(end_s, path.end_s());
  for (double time_s = 0; time_s < end_s; time_s += 0.1) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const Pose a = *paths[i].at(time_s), b = *paths[k].at(time_s);
        least = std::min(least, std::hypot(a.x - b.x, a.y - b.y));
      }
    }
  }
  return least;
}

TEST(Courtyards, SensorsAreThoseOfSeed000) {
  for (const RobotPlan& robot : load_scenario("courtyards").robots) {
    EXPECT_EQ(robot.laser.beams, 181);
    EXPECT_NEAR(robot.laser.field_of_view_rad, std::numbers::pi, 1e-12);
    EXPECT_EQ(robot.laser.laser.range_max_m, 8);
    EXPECT_EQ(robot.laser.range_sigma_m, 0.003);
    EXPECT_EQ(robot.laser.bearing_sigma_rad, 0.003);
    EXPECT_EQ(robot.odometry.linear_share, 0.03);
    EXPECT_EQ(robot.odometry.angular_share, 0.05);
    EXPECT_EQ(robot.odometry.angular_floor_rps, 0.0017);
    EXPECT_EQ(robot.camera.range_sigma_m, 0.02);
    EXPECT_EQ(robot.camera.bearing_sigma_rad, 0.07);
  }
}

TEST(Courtyards, BuildingIsAsLargeAsSeed000s) {
  const FloorPlan plan = load_scenario("courtyards").plan;
  const double courtyards_m2 = 22 * 19 + 22 * 19;
  EXPECT_NEAR((plan.high - plan.low).prod() - courtyards_m2, 3000, 100);
}

TEST(Courtyards, RobotsMeetSeveralTimesAndNeverTouch) {
  const Scenario scenario = load_scenario("courtyards", {"laser.rate_hz=0"});
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    EXPECT_GE(beginnings_of_meetings(scenario, simulate(scenario, seed)).size(), 5U);
    EXPECT_GT(min_distance_m(scenario, seed), 0.6);
  }
}

// R3 comes back to where it was after the whole ring of corridors.
TEST(Courtyards, OneRobotDrivesTheWholeRing) {
  const TruePath path = drive(load_scenario("courtyards").robots.at(2), 1);
  Vector2d low(1e9, 1e9), high = -low;
  double length_m = 0;
  const auto& poses = path.stretches().at(0).world_from_robot;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    low = low.cwiseMin(Vector2d(poses[i].x, poses[i].y));
    high = high.cwiseMax(Vector2d(poses[i].x, poses[i].y));
    length_m += std::hypot(poses[i].x - poses[i - 1].x, poses[i].y - poses[i - 1].y);
  }
  EXPECT_GT(2 * (high - low).sum(), 195);
  EXPECT_GT(length_m, 200);
}

TEST(DoubleSpiral, RobotsSeeOneAnotherOnlyAfterTheThirdLap) {
  const Scenario scenario = load_scenario("double_spiral", {"laser.rate_hz=0"});
  const Vector2d middle(13.7, 10.6);
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const SimulatedRun run = simulate(scenario, seed);
    const auto beginnings = beginnings_of_meetings(scenario, run);
    ASSERT_EQ(beginnings.size(), 1U);
    for (std::size_t i = 0; i < 2; ++i) {
      const TruePath path = drive(scenario.robots[i], seed);
      double turned = 0, before = 0;
      for (double time_s = 0; time_s < beginnings[0]; time_s += 0.1) {
        const Pose pose = *path.at(time_s);
        const double angle = std::atan2(pose.y - middle.y(), pose.x - middle.x());
        if (time_s > 0) turned += wrap_angle(angle - before);
        before = angle;
      }
      const double laps = turned / (2 * std::numbers::pi);
      EXPECT_NEAR(laps, i == 0 ? 3 : -3, 0.2) << seed;
    }
  }
}

TEST(DoubleSpiral, RobotsMeetFaceToFaceForSomeSeconds) {
  const Scenario scenario = load_scenario("double_spiral", {"laser.rate_hz=0"});
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const auto paths = paths_of(scenario, seed);
    int face_to_face = 0;
    for (double time_s = scenario.robots[0].camera.from_s; time_s < 450; time_s += 0.1) {
      const Pose seen = ominus(*paths[1].at(time_s), *paths[0].at(time_s));
      const bool ahead = std::abs(std::atan2(seen.y, seen.x)) < 0.35 && std::hypot(seen.x, seen.y) < 4;
      if (ahead && std::abs(wrap_angle(seen.yaw - std::numbers::pi)) < 0.4) ++face_to_face;
    }
    EXPECT_GT(face_to_face, 30) << seed;
    EXPECT_GT(min_distance_m(scenario, seed), 0.6);
  }
}

TEST(Meeting, RobotsMeetTwiceInAMinute) {
  const Scenario scenario = load_scenario("meeting", {"laser.rate_hz=0"});
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const SimulatedRun run = simulate(scenario, seed);
    const auto beginnings = beginnings_of_meetings(scenario, run);
    ASSERT_EQ(beginnings.size(), 2U) << seed;
    EXPECT_GT(beginnings[0], 4);
    EXPECT_LT(seconds_of(scenario, run.events.back().receive_utime), 75);
    EXPECT_GT(min_distance_m(scenario, seed), 0.6);
  }
}

TEST(OneWay, OnlyOneRobotSeesAndOnlyTheOtherIsSeen) {
  int sightings = 0;
  std::map<std::string, int> barcodes;
  for (const Event& event : simulate(load_scenario("one_way"), 1).events) {
    if (const auto* robot = std::get_if<RobotEvent>(&event.body)) barcodes[robot->robot] = robot->barcode;
    const auto* sighting = std::get_if<SightingEvent>(&event.body);
    if (sighting == nullptr) continue;
    EXPECT_EQ(sighting->robot, "R1");
    EXPECT_EQ(sighting->barcode, 102);
    ++sightings;
  }
  EXPECT_GT(sightings, 20);
  EXPECT_EQ(barcodes, (std::map<std::string, int>{{"R1", -1}, {"R2", 102}}));
}

TEST(Blind, RobotsDeclareThatTheyHaveNoLaserAndSeeTagsAndOneAnother) {
  std::map<std::string, std::set<int>> seen;
  for (const Event& event : simulate(load_scenario("blind"), 1).events) {
    EXPECT_FALSE(std::holds_alternative<ScanEvent>(event.body));
    if (const auto* robot = std::get_if<RobotEvent>(&event.body)) {
      EXPECT_EQ(robot->laser.range_min_m, 0);
      EXPECT_EQ(robot->laser.range_max_m, 0);
    }
    if (const auto* sighting = std::get_if<SightingEvent>(&event.body))
      seen[sighting->robot].insert(sighting->barcode);
  }
  EXPECT_TRUE(seen["R1"].contains(102));
  EXPECT_TRUE(seen["R2"].contains(101));
  seen["R1"].merge(seen["R2"]);
  EXPECT_EQ(seen["R1"].size(), 12U + 2U);
}

TEST(Blind, TruthHasPosesAtTenHertzAtStampsOfTheOdometry) {
  for (const std::string rate : {"10", "20", "33"}) {
    const SimulatedRun run = simulate(load_scenario("blind", {"odometry.rate_hz=" + rate}), 1);
    std::map<std::string, std::set<std::int64_t>> stamps;
    for (const Event& event : run.events) {
      if (const auto* odometry = std::get_if<OdometryEvent>(&event.body))
        stamps[odometry->robot].insert(odometry->utime);
    }
    for (const RobotTruth& robot : run.truth) {
      ASSERT_GT(robot.poses.size(), 500U);
      for (std::size_t i = 0; i < robot.poses.size(); ++i) {
        EXPECT_TRUE(stamps[robot.robot].contains(robot.poses[i].utime));
        if (i == 0) continue;
        const std::int64_t gap_us = robot.poses[i].utime - robot.poses[i - 1].utime;
        EXPECT_GE(gap_us, 99'990);
        EXPECT_LE(gap_us, 130'000);
      }
    }
  }
}

TEST(Camera, ReadsNothingBeforeItsTime) {
  const Scenario scenario =
      load_scenario("meeting", {"camera.from_s=20", "false_sightings=0.3", "laser.rate_hz=0"});
  double first_s = 1e9;
  for (const Event& event : simulate(scenario, 1).events) {
    if (const auto* sighting = std::get_if<SightingEvent>(&event.body))
      first_s = std::min(first_s, seconds_of(scenario, sighting->utime));
  }
  EXPECT_GE(first_s, 20);
  EXPECT_LT(first_s, 60);
}

}  // namespace
}  // namespace isthmus
