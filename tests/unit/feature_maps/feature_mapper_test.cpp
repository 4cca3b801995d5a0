#include "server/feature_maps/mapper/feature_mapper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "server/feature_maps/output/feature_files.hpp"
#include "tests/support/feature_events.hpp"

namespace isthmus {
namespace {

using testing::add_box;
using testing::FeatureEvents;
using testing::Walls;

FeatureMaps mapped(const FeatureEvents& run, FeatureMapKind kind) {
  FeatureMapper mapper(feature_map_options(kind));
  for (const Event& event : run.events) mapper.handle(event);
  mapper.finish();
  return mapper.maps();
}

/// A hall of 12 m by 8 m with a block in it.
Walls hall() {
  Walls walls;
  add_box(walls, -6, -4, 6, 4);
  add_box(walls, 1, 1, 3, 2.2);
  return walls;
}

Pose at(double x, double y, double yaw) { return {x, y, yaw}; }

/// A robot drives 3 m ahead from `start` through the hall, 0.15 m a scan.
void drive(FeatureEvents& run, const std::string& robot, const Pose& start) {
  for (int i = 0; i <= 20; ++i) {
    const Pose driven = at(0.15 * i, 0, 0.01 * i);
    run.odometry(robot, driven);
    run.scan(robot, hall(), start * driven);
    run.wait(0.2);
  }
}

FeatureEvents one_robot() {
  FeatureEvents run;
  run.declare("R1", 101, 20);
  drive(run, "R1", at(-4, -1, 0.2));
  return run;
}

TEST(FeatureMapper, ARobotMapsTheWallsOfAHallAndItsWay) {
  const FeatureMaps maps = mapped(one_robot(), FeatureMapKind::segments);
  ASSERT_EQ(maps.teams.size(), 1u);
  const FeatureState& state = maps.teams[0].filter.state();
  EXPECT_GE(state.features.size(), 4u);
  EXPECT_LE(state.features.size(), 8u);
  const Pose world_from_map = at(-4, -1, 0.2);
  double total_m = 0;
  for (const FeatureInState& entry : state.features) {
    const Feature wall = world_from_map * entry.feature;
    const double off = std::min(std::abs(across(wall).x()), std::abs(across(wall).y()));
    EXPECT_LT(off, 0.02) << "a wall stands askew";
    total_m += length_m(wall);
  }
  EXPECT_GT(total_m, 25);
  ASSERT_EQ(maps.journeys.size(), 1u);
  ASSERT_EQ(maps.journeys[0].rows.size(), 21u);
  const Pose& last = maps.journeys[0].rows.back().map_from_robot;
  EXPECT_NEAR(last.x, 3, 0.02);
  EXPECT_NEAR(last.yaw, 0.2, 0.01);
}

TEST(FeatureMapper, AScanTellsThatWheelsSlipped) {
  FeatureEvents run = one_robot();
  for (int i = 1; i <= 3; ++i) {  // pushed aside and turned, which odometry does not tell
    run.odometry("R1", at(3 + 0.15 * i, 0, 0.2));
    run.scan("R1", hall(), at(-4, -1, 0.2) * at(3, -0.5, 0.5) * at(0.15 * i, 0, 0));
    run.wait(0.2);
  }
  const FeatureMaps maps = mapped(run, FeatureMapKind::segments);
  EXPECT_EQ(maps.counts.scans_tracked, maps.counts.scans_used - 1);
  const Pose truth = at(3, -0.5, 0.5) * at(0.45, 0, 0);
  const Pose& last = maps.journeys[0].rows.back().map_from_robot;
  EXPECT_NEAR(last.x, truth.x, 0.05);
  EXPECT_NEAR(last.y, truth.y, 0.05);
  EXPECT_NEAR(last.yaw, truth.yaw, 0.02);
}

TEST(FeatureMapper, RobotsThatSeeOneAnotherComeToOneMap) {
  FeatureEvents run;
  const Pose one = at(-4, -1, 0.2), two = at(5, -2, 3);
  run.declare("R1", 101, 20);
  run.declare("R2", 102, 20);
  drive(run, "R1", one);
  drive(run, "R2", two);
  const Pose end = at(3, 0, 0.2), here = one * end, there = two * end;
  for (int meeting = 0; meeting < 2; ++meeting) {
    run.odometry("R1", end);
    run.odometry("R2", end);
    run.sighting("R1", 102, position(ominus(there, here)));
    run.sighting("R2", 101, position(ominus(here, there)));
    run.wait(2);
  }
  const FeatureMaps maps = mapped(run, FeatureMapKind::segments);
  ASSERT_EQ(maps.teams.size(), 1u);
  EXPECT_EQ(maps.counts.fusions, 1);
  const auto& robots = maps.teams[0].filter.state().robots;
  const auto pose_of = [&](std::size_t journey) {
    return robots.at(static_cast<std::size_t>(maps.journeys.at(journey).member)).map_from_robot;
  };
  const Pose found = ominus(pose_of(1), pose_of(0)), truth = ominus(there, here);
  EXPECT_NEAR(found.x, truth.x, 0.03);
  EXPECT_NEAR(found.y, truth.y, 0.03);
  EXPECT_NEAR(wrap_angle(found.yaw - truth.yaw), 0, 0.01);
  // Both ways lie in one map from their beginning.
  const Pose begun_1 = maps.journeys[0].rows.front().map_from_robot;
  const Pose begun_2 = maps.journeys[1].rows.front().map_from_robot;
  EXPECT_NEAR(ominus(begun_2, begun_1).x, ominus(two, one).x, 0.05);
  // What R2 saw is known by the names that it has there.
  int known = 0, views = 0;
  for (const Stop& stop : maps.journeys[1].stops) {
    for (const FeatureView& view : stop.views) {
      const auto index = index_of(maps.teams[0].filter.state(), view.id);
      ++views;
      if (!index) continue;
      const Feature& its = maps.teams[0].filter.state().features[*index].feature;
      known += std::abs(local_coordinates(its, stop.map_from_robot * view.seen.feature)(1)) < 0.1;
    }
  }
  EXPECT_GT(views, 20);
  EXPECT_GT(known, 9 * views / 10);
}

TEST(FeatureMapper, OneMeetingThatNothingBearsOutWaitsForAnother) {
  FeatureEvents run;
  run.declare("R1", 101, 20);
  run.declare("R2", 102, 20);
  const auto meet = [&](double bearing_rad) {
    run.odometry("R1", {});
    run.odometry("R2", {});
    run.sighting("R1", 102, {3 * std::cos(bearing_rad), 3 * std::sin(bearing_rad)});
    run.sighting("R2", 101, {3, 0});
    run.wait(2);
  };
  meet(0.5);
  EXPECT_EQ(mapped(run, FeatureMapKind::segments).teams.size(), 2u);
  meet(-1.5);  // another wrong one
  EXPECT_EQ(mapped(run, FeatureMapKind::segments).teams.size(), 2u);
  meet(0.5);
  EXPECT_EQ(mapped(run, FeatureMapKind::segments).teams.size(), 1u);
}

/// Three robots in a hall of 27 m, each of which sees 4 m of it; they know one another from farther away.
struct LongHall {
  FeatureEvents run;
  std::map<std::string, Pose> starts = {
      {"R1", at(0, 0, 0)}, {"R2", at(19, 0, 3.1)}, {"R3", at(20, 0.4, 3.1)}};
  std::map<std::string, Pose> driven = {{"R1", {}}, {"R2", {}}, {"R3", {}}};

  LongHall() {
    std::int32_t barcode = 101;
    for (const auto& [robot, start] : starts) run.declare(robot, barcode++, 4);
  }
  Pose pose(const std::string& robot) const { return starts.at(robot) * driven.at(robot); }
  void drive(const std::string& robot, int steps) {
    for (int i = 0; i < steps; ++i) {
      driven[robot] = driven[robot] * at(0.15, 0, 0);
      run.odometry(robot, driven[robot]);
      run.scan(robot, testing::niched_hall(), pose(robot));
      run.wait(0.2);
    }
  }
  void meet(const std::string& one, const std::string& other) {
    for (int meeting = 0; meeting < 3; ++meeting) {
      run.odometry(one, driven[one]);
      run.odometry(other, driven[other]);
      run.sighting(one, 100 + (other[1] - '0'), position(ominus(pose(other), pose(one))));
      run.sighting(other, 100 + (one[1] - '0'), position(ominus(pose(one), pose(other))));
      run.wait(3);
    }
  }
};

std::size_t marks_in(const FeatureMaps& maps) {
  std::size_t count = 0;
  for (const Team& team : maps.teams) count += team.filter.state().marks.size();
  return count;
}

TEST(FeatureMapper, MapsOfRobotsThatMetWaitUntilTheyHaveAWallInCommon) {
  LongHall hall;
  hall.drive("R1", 15);
  hall.drive("R2", 15);
  hall.meet("R1", "R2");
  const FeatureMaps before = mapped(hall.run, FeatureMapKind::segments);
  ASSERT_EQ(before.teams.size(), 2u);
  ASSERT_EQ(before.fusions.size(), 1u);
  EXPECT_EQ(before.fusions[0].state, FusionState::waiting);
  EXPECT_GT(before.fusions[0].log_odds(), 20);
  EXPECT_EQ(marks_in(before), 2u) << "where they last met";
  hall.drive("R2", 100);
  const FeatureMaps after = mapped(hall.run, FeatureMapKind::segments);
  ASSERT_EQ(after.teams.size(), 1u);
  EXPECT_EQ(after.fusions.at(0).state, FusionState::accepted);
  EXPECT_EQ(after.fusions[0].id, before.fusions[0].id);
  EXPECT_GT(after.fusions[0].duplicates, 0u);
  EXPECT_EQ(marks_in(after), 0u);
  for (const FeatureSighting& sighting : after.sightings) EXPECT_TRUE(sighting.used) << sighting.reason;
  const auto last = [&](std::size_t journey) {
    return after.journeys.at(journey).rows.back().map_from_robot;
  };
  const Pose found = ominus(last(1), last(0)), truth = ominus(hall.pose("R2"), hall.pose("R1"));
  EXPECT_LT((position(found) - position(truth)).norm(), 0.05);
  EXPECT_NEAR(wrap_angle(found.yaw - truth.yaw), 0, 0.01);
}

TEST(FeatureMapper, AMapThatBecomesPartOfAnotherBringsItsMeetingsWithIt) {
  LongHall hall;
  hall.drive("R1", 15);
  hall.drive("R2", 15);
  hall.drive("R3", 15);
  hall.meet("R1", "R3");  // which share nothing
  hall.meet("R3", "R2");  // which stand in the same end of the hall
  const FeatureMaps two = mapped(hall.run, FeatureMapKind::segments);
  ASSERT_EQ(two.teams.size(), 2u);
  EXPECT_EQ(two.journeys[1].team, two.journeys[2].team);
  EXPECT_EQ(marks_in(two), 2u);
  hall.drive("R1", 100);
  const FeatureMaps one = mapped(hall.run, FeatureMapKind::segments);
  ASSERT_EQ(one.teams.size(), 1u);
  EXPECT_EQ(marks_in(one), 0u);
  const auto last = [&](std::size_t journey) { return one.journeys.at(journey).rows.back().map_from_robot; };
  for (const std::size_t other : {1U, 2U}) {
    const Pose found = ominus(last(other), last(0));
    const Pose truth = ominus(hall.pose(other == 1 ? "R2" : "R3"), hall.pose("R1"));
    EXPECT_LT((position(found) - position(truth)).norm(), 0.06);
  }
}

const std::vector<Eigen::Vector2d> landmarks = {{3, 1}, {4, -2}, {1, 3}, {-2, 2}};

/// Robots without lasers that each see the landmarks in turn, from where they stand.
FeatureEvents among_landmarks(const std::vector<Pose>& robots) {
  FeatureEvents run;
  for (std::size_t i = 0; i < robots.size(); ++i)
    run.declare("R" + std::to_string(i + 1), static_cast<int>(100 + i), 0);
  for (std::size_t k = 0; k < landmarks.size(); ++k) run.tag(static_cast<int>(k));
  for (int round = 0; round < 5; ++round) {
    for (std::size_t i = 0; i < robots.size(); ++i) {
      const std::string name = "R" + std::to_string(i + 1);
      run.odometry(name, {});
      for (std::size_t k = 0; k < landmarks.size(); ++k)
        run.sighting(name, static_cast<int>(k), inverse(robots[i]) * landmarks[k]);
    }
    run.wait(1);
  }
  return run;
}

TEST(FeatureMapper, RobotsThatKnowTheSameLandmarksComeToOneMap) {
  const std::vector<Pose> robots = {at(0, 0, 0.3), at(2, -1, 2), at(-1, 4, -1)};
  const FeatureMaps maps = mapped(among_landmarks(robots), FeatureMapKind::points);
  ASSERT_EQ(maps.teams.size(), 1u);
  const Team& team = maps.teams[0];
  EXPECT_EQ(team.filter.state().features.size(), landmarks.size());
  const Pose world_from_map = robots[0];
  for (const auto& [barcode, id] : team.landmarks) {
    const std::size_t index = *index_of(team.filter.state(), id);
    const Eigen::Vector2d found = world_from_map * team.filter.state().features[index].feature.a;
    EXPECT_NEAR((found - landmarks[static_cast<std::size_t>(barcode)]).norm(), 0, 1e-6);
  }
}

TEST(FeatureMapper, WhatRobotsSawBeforeTheirMapsWereOneNamesFeaturesOfTheJointMap) {
  const std::vector<Pose> robots = {at(0, 0, 0.3), at(2, -1, 2), at(-1, 4, -1)};
  const FeatureMaps maps = mapped(among_landmarks(robots), FeatureMapKind::points);
  ASSERT_EQ(maps.teams.size(), 1u);
  const FeatureState& state = maps.teams[0].filter.state();
  int views = 0;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    for (const Stop& stop : maps.journeys.at(i).stops) {
      for (const FeatureView& view : stop.views) {
        const auto index = index_of(state, view.id);
        ASSERT_TRUE(index) << view.id;
        const Eigen::Vector2d seen = robots[i] * view.seen.feature.a;
        EXPECT_NEAR((robots[0] * state.features[*index].feature.a - seen).norm(), 0, 1e-6);
        EXPECT_NEAR((robots[0] * (stop.map_from_robot * view.seen.feature.a) - seen).norm(), 0, 1e-6);
        ++views;
      }
    }
  }
  EXPECT_GE(views, 40);
}

TEST(FeatureMapper, ALandmarkSeenWhereItIsNotIsRefused) {
  FeatureEvents run = among_landmarks({at(0, 0, 0.3)});
  run.odometry("R1", {});
  run.sighting("R1", 0, {-3, -3});
  const FeatureMaps maps = mapped(run, FeatureMapKind::points);
  EXPECT_EQ(maps.sightings.back().reason, "contradicts_map");
  EXPECT_EQ(map_sha256(maps).size(), 64u);
  const std::size_t index = *index_of(maps.teams[0].filter.state(), maps.teams[0].landmarks.at(0));
  EXPECT_NEAR((at(0, 0, 0.3) * maps.teams[0].filter.state().features[index].feature.a - landmarks[0]).norm(),
              0, 1e-6);
}

TEST(FeatureMapper, BadInputIsCountedAndChangesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  FeatureEvents run = one_robot();
  const std::string before = features_csv(mapped(run, FeatureMapKind::segments));
  run.odometry("NOBODY", {});
  run.odometry("R1", {nan, 0, 0});
  run.scan("NOBODY", hall(), {});
  run.sighting("R1", 7, {1, 1});
  run.sighting("R1", 7, {0, 0});
  const FeatureMaps maps = mapped(run, FeatureMapKind::segments);
  EXPECT_EQ(maps.counts.dropped.at("unknown_robot"), 2);
  EXPECT_EQ(maps.counts.dropped.at("not_finite"), 1);
  ASSERT_EQ(maps.sightings.size(), 2u);
  EXPECT_EQ(maps.sightings[0].reason, "unknown_barcode");
  EXPECT_EQ(maps.sightings[1].reason, "incomplete");
  EXPECT_EQ(features_csv(maps), before);
}

TEST(FeatureMapper, ARestartBeginsAMapOfItsOwn) {
  FeatureEvents run = one_robot();
  RobotEvent again = std::get<RobotEvent>(run.events[0].body);
  again.restarted = true;
  run.add(again);
  drive(run, "R1", at(-4, -1, 0.2));
  const FeatureMaps maps = mapped(run, FeatureMapKind::segments);
  EXPECT_EQ(maps.teams.size(), 2u);
  EXPECT_EQ(maps.journeys.size(), 2u);
}

TEST(FeatureMapper, TheSameEventsGiveTheSameMapAndOthersAnother) {
  FeatureEvents run = one_robot();
  const std::string once = map_sha256(mapped(run, FeatureMapKind::segments));
  EXPECT_EQ(once, map_sha256(mapped(run, FeatureMapKind::segments)));
  run.events.pop_back();
  EXPECT_NE(once, map_sha256(mapped(run, FeatureMapKind::segments)));
}

}  // namespace
}  // namespace isthmus
