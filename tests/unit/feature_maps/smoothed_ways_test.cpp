#include "server/feature_maps/ways/smoothed_ways.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "server/feature_maps/mapper/journey.hpp"

namespace isthmus {
namespace {

const LocalMatrix point_noise = 1e-4 * LocalMatrix::Identity(2, 2);
const Eigen::Matrix3d step_noise = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();

/// Points along a way of steps of 1 m along x; ids from 0.
FeatureState pillars(int count) {
  FeatureState map;
  map.robots.push_back({{}, 0});
  for (int i = 0; i < count; ++i)
    map.features.push_back({i, point_feature({1.0 * i, 1 + (i % 2)}), 0, 3 + 2 * i});
  map.next_id = count;
  return map;
}

Pose true_pose(int i) { return {1.0 * i, 0, 0}; }

FeatureView view(int id, const FeatureState& map, const Pose& robot) {
  return {id, false, {inverse(robot) * map.features.at(static_cast<std::size_t>(id)).feature, point_noise}};
}

/// A robot that drives along x; the filter had it beside its way by more and more.
std::vector<Stop> driven(int count) {
  std::vector<Stop> stops;
  for (int i = 0; i < count; ++i) {
    Stop stop;
    stop.utime = 1'000'000 * i;
    stop.map_from_robot = {1.0 * i, 0.02 * i * i, 0.04 * i};
    if (i > 0) stop.from_last = {{1, 0, 0}, step_noise};
    stops.push_back(stop);
  }
  return stops;
}

/// The same, with three pillars seen from each stop as they are.
std::vector<Stop> driven_seeing(int count, const FeatureState& map) {
  std::vector<Stop> stops = driven(count);
  for (int i = 0; i < count; ++i)
    for (const int id : {i, i + 1, i + 2})
      stops[static_cast<std::size_t>(i)].views.push_back(view(id, map, true_pose(i)));
  return stops;
}

void expect_near(const Pose& pose, const Pose& expected, double tolerance) {
  EXPECT_NEAR(pose.x, expected.x, tolerance);
  EXPECT_NEAR(pose.y, expected.y, tolerance);
  EXPECT_NEAR(pose.yaw, expected.yaw, tolerance);
}

std::vector<Pose> smoothed(const std::vector<Stop>& stops, const FeatureState& map) {
  const std::span<const Stop> way(stops);
  return smoothed_stops({&way, 1}, map).at(0);
}

TEST(SmoothedWays, AWayFollowsTheFeaturesToWhereTheMapHasThem) {
  const FeatureState map = pillars(12);
  std::vector<Stop> stops = driven_seeing(10, map);
  const std::vector<Pose> poses = smoothed(stops, map);
  for (int i = 0; i < 10; ++i) expect_near(poses.at(static_cast<std::size_t>(i)), true_pose(i), 1e-6);
}

TEST(SmoothedWays, WhereNothingWasSeenStepsTellTheWayFromBothSides) {
  const FeatureState map = pillars(12);
  std::vector<Stop> stops = driven(9);
  for (const int i : {0, 8})
    for (const int id : {i, i + 1, i + 2})
      stops[static_cast<std::size_t>(i)].views.push_back(view(id, map, true_pose(i)));
  for (std::size_t i = 1; i < stops.size(); ++i) stops[i].from_last.start_from_end = {1.01, 0, 0};
  const std::vector<Pose> poses = smoothed(stops, map);
  expect_near(poses.at(4), true_pose(4), 5e-3);
  EXPECT_NEAR(poses.at(2).x - poses.at(1).x, 1, 2e-3) << "each step gives a little";
}

TEST(SmoothedWays, AWallTakenForAnotherMovesNothing) {
  const FeatureState map = pillars(12);
  std::vector<Stop> stops = driven_seeing(10, map);
  stops[4].views[1].id = 9;   // 4 m beside it
  stops[6].views[0].id = 77;  // which has gone
  const std::vector<Pose> poses = smoothed(stops, map);
  for (int i = 0; i < 10; ++i) expect_near(poses.at(static_cast<std::size_t>(i)), true_pose(i), 2e-3);
}

TEST(SmoothedWays, ARobotThatSeesNoFeaturesIsPlacedByAnotherThatSeesIt) {
  const FeatureState map = pillars(12);
  std::vector<Stop> seeing = driven(6), seen = driven(6);
  for (int i = 0; i < 6; ++i) {
    const auto at = static_cast<std::size_t>(i);
    for (const int id : {i, i + 1, i + 2}) seeing[at].views.push_back(view(id, map, true_pose(i)));
    // The other drives beside it, 2 m to the right.
    seeing[at].robots.push_back({1, i, {0, 1, 2, -std::numbers::pi / 2, 0.01, 0.01}});
  }
  const std::vector<std::span<const Stop>> ways{seeing, seen};
  const auto poses = smoothed_stops(ways, map);
  for (int i = 0; i < 6; ++i) {
    const auto at = static_cast<std::size_t>(i);
    expect_near(poses.at(0).at(at), true_pose(i), 1e-3);
    expect_near(poses.at(1).at(at), {1.0 * i, -2, 0}, 1e-3);
  }
}

TEST(SmoothedWays, ASightingOfARobotOnAnotherMapIsLeftOut) {
  const FeatureState map = pillars(4);
  std::vector<Stop> stops = driven_seeing(2, map);
  stops[1].robots = {{1, 0, {0, 1, 2, 0, 0.01, 0.01}}, {7, 0, {0, 1, 2, 0, 0.01, 0.01}}};
  const std::vector<std::span<const Stop>> ways{stops, {}};
  const auto poses = smoothed_stops(ways, map);
  expect_near(poses.at(0).at(1), true_pose(1), 1e-6);
  EXPECT_TRUE(poses.at(1).empty());
}

TEST(SmoothedWays, AWayOfNoMeasurementsStaysAsTheFilterHadItsStart) {
  std::vector<Stop> stops = driven(3);
  for (std::size_t i = 0; i < stops.size(); ++i)
    stops[i].map_from_robot = {5.0 + static_cast<double>(i), 2, 0};
  const std::vector<Pose> poses = smoothed(stops, pillars(1));
  for (std::size_t i = 0; i < stops.size(); ++i) expect_near(poses.at(i), stops[i].map_from_robot, 1e-6);
}

TEST(SmoothedWays, WhatIsNotFiniteLeavesTheWayAsTheFilterHadIt) {
  std::vector<Stop> stops = driven(3);
  stops[1].from_last.start_from_end.x = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Pose> poses = smoothed(stops, pillars(1));
  for (std::size_t i = 0; i < stops.size(); ++i) expect_near(poses.at(i), stops[i].map_from_robot, 1e-12);
}

TEST(SmoothedWays, RowsBetweenStopsMoveWithThemAndTakeWhatStepsErrByLittleByLittle) {
  const FeatureState map = pillars(6);
  Journey journey;
  journey.team = 0;
  journey.stops = driven(3);
  for (const int i : {0, 2})
    for (const int id : {i, i + 1, i + 2})
      journey.stops[static_cast<std::size_t>(i)].views.push_back(view(id, map, true_pose(i)));
  journey.stops.erase(journey.stops.begin() + 1);  // the filter went on by a step of 2.2 m; it was 2 m
  journey.stops[1].from_last = {{2.2, 0, 0}, 1e4 * step_noise};
  journey.rows = {{-500'000, {-0.5, 0, 0}},
                  {0, journey.stops[0].map_from_robot},
                  {1'000'000, {1.1, 0, 0}},
                  {2'000'000, journey.stops[1].map_from_robot},
                  {2'500'000, journey.stops[1].map_from_robot * Pose{0.5, 0, 0}}};
  smooth({&journey, 1}, 0, map);
  expect_near(journey.rows[0].map_from_robot, {-0.5, 0, 0}, 1e-3);
  expect_near(journey.rows[1].map_from_robot, true_pose(0), 1e-3);
  expect_near(journey.rows[2].map_from_robot, true_pose(1), 1e-3);
  expect_near(journey.rows[3].map_from_robot, true_pose(2), 1e-3);
  expect_near(journey.rows[4].map_from_robot, {2.5, 0, 0}, 1e-3);
  Journey elsewhere = journey;
  elsewhere.team = 1;
  elsewhere.rows[0].map_from_robot.x = 9;
  smooth({&elsewhere, 1}, 0, map);
  EXPECT_EQ(elsewhere.rows[0].map_from_robot.x, 9) << "it is on another map";
}

}  // namespace
}  // namespace isthmus
