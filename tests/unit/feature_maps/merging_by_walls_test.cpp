#include <gtest/gtest.h>

#include "server/feature_maps/feature_estimator.hpp"
#include "server/feature_maps/output/feature_files.hpp"
#include "tests/support/buildings.hpp"
#include "tests/support/feature_estimates.hpp"

namespace isthmus {
namespace {

using testing::FeatureEvents;
using testing::Walls;

/// Two robots that drive through a building to and fro, one from either side, and never see one another: to
/// the end of their stretch, and back again with their lasers to the other side.
struct TwoWays {
  FeatureEvents run;
  Pose start_1{1, 6, 0}, start_2{47, 6, 3.1};

  explicit TwoWays(const Walls& walls, double way_m = 31) {
    run.declare("R1", 101, 20);
    run.declare("R2", 102, 20);
    Pose driven;
    const int steps = static_cast<int>(way_m / 0.25);
    const auto step = [&](const Pose& move) {
      driven = driven * move;
      for (const auto& [robot, start] : {std::pair("R1", start_1), std::pair("R2", start_2)}) {
        run.odometry(robot, driven);
        run.scan(robot, walls, start * driven);
      }
      run.wait(0.2);
    };
    for (int i = 0; i < steps; ++i) step({0.25, 0, 0});
    for (int i = 0; i < 10; ++i) step({0, 0, 0.1 * 3.14159265});
    for (int i = 0; i < steps; ++i) step({0.25, 0, 0});
    last = driven;
  }
  Pose last;
};

Event withdrawal(const FeatureEvents& run, std::int64_t id, Verb verb = Verb::withdraw) {
  return {run.events.back().receive_utime, CommandEvent{0, verb, id, ""}};
}

const TwoWays& store() {
  static const TwoWays ways(testing::store_of_crates());
  return ways;
}

/// What comes of both ways, once for all tests.
const FeatureEstimator& mapped() {
  static const FeatureEstimator estimator = estimate(store().run);
  return estimator;
}

TEST(MergingByWalls, RobotsThatNeverSeeOneAnotherComeToOneMap) {
  const FeatureMaps maps = mapped().maps();
  ASSERT_EQ(maps.teams.size(), 1U);
  ASSERT_EQ(maps.fusions.size(), 1U);
  EXPECT_EQ(maps.fusions[0].state, FusionState::accepted);
  EXPECT_GE(maps.fusions[0].id, first_by_walls);
  EXPECT_EQ(maps.fusions[0].robots, (std::vector<std::string>{"R1", "R2"}));
  const auto& robots = maps.teams[0].filter.state().robots;
  const auto of = [&](std::size_t journey) {
    return robots.at(static_cast<std::size_t>(maps.journeys.at(journey).member)).map_from_robot;
  };
  const Pose found = ominus(of(1), of(0));
  const Pose truth = ominus(store().start_2 * store().last, store().start_1 * store().last);
  EXPECT_NEAR(found.x, truth.x, 0.1);
  EXPECT_NEAR(found.y, truth.y, 0.1);
  EXPECT_NEAR(wrap_angle(found.yaw - truth.yaw), 0, 0.02);
  EXPECT_NEAR(
      ominus(maps.journeys[1].rows.front().map_from_robot, maps.journeys[0].rows.front().map_from_robot).x,
      46, 1)
      << "ways lie in one map from their beginning";
}

TEST(MergingByWalls, AFusionIsWithdrawnForbiddenAndReplayedWithout) {
  FeatureEstimator live = mapped();
  const std::string before = map_sha256(live.maps());
  ASSERT_EQ(live.maps().fusions.size(), 1U);
  const std::int32_t id = live.maps().fusions[0].id;
  EXPECT_EQ(live.handle(withdrawal(store().run, id)).drop_reason, DropReason::none);
  const FeatureMaps without = live.maps();
  EXPECT_EQ(without.teams.size(), 2U);
  EXPECT_EQ(map_sha256(without), map_sha256(estimate(store().run, {id}).maps()));
  ASSERT_EQ(without.fusions.size(), 1U);
  EXPECT_EQ(without.fusions[0].state, FusionState::withdrawn);
  EXPECT_EQ(live.handle(withdrawal(store().run, id, Verb::allow)).drop_reason, DropReason::none);
  EXPECT_EQ(map_sha256(live.maps()), before);
}

TEST(MergingByWalls, WhatIsRestoredFromItsBytesComesToTheSameMap) {
  const FeatureMaps whole = mapped().maps();
  const std::vector<Event>& events = store().run.events;
  FeatureEstimator live(feature_map_options(FeatureMapKind::segments));
  std::size_t handled = 0;
  for (const std::size_t share : {3U, 6U, 9U}) {
    for (const std::size_t split = events.size() * share / 10; handled < split; ++handled)
      live.handle(events[handled]);
    FeatureEstimator restored = FeatureEstimator::restore(FeatureMapKind::segments, live.save());
    EXPECT_EQ(restored.save(), live.save());
    for (std::size_t i = handled; i < events.size(); ++i) restored.handle(events[i]);
    Outcome outcome;
    restored.finish_step(outcome);
    EXPECT_EQ(map_sha256(restored.maps()), map_sha256(whole));
    EXPECT_EQ(restored.maps().fusions.at(0).id, whole.fusions.at(0).id);
  }
}

/// Robots that see one another elsewhere than the map has them, again and again.
TEST(MergingByWalls, EncountersAfterwardsTakeItBack) {
  ASSERT_EQ(mapped().maps().teams.size(), 1U);
  FeatureEvents run = store().run;
  const std::size_t driven = run.events.size();
  const Pose one = store().start_1 * store().last, two = Pose{3, 2, 1} * store().start_2 * store().last;
  for (int i = 0; i < 12; ++i) {
    run.odometry("R1", store().last);
    run.odometry("R2", store().last);
    run.sighting("R1", 102, position(ominus(two, one)));
    run.sighting("R2", 101, position(ominus(one, two)));
    run.wait(3);
  }
  FeatureEstimator live = mapped();
  for (std::size_t i = driven; i < run.events.size(); ++i) live.handle(run.events[i]);
  const FeatureMaps maps = live.maps();
  EXPECT_GE(maps.counts.withdrawn, 1);
  for (const FusionRecord& fusion : maps.fusions)
    EXPECT_FALSE(fusion.placing && fusion.state == FusionState::accepted);
}

}  // namespace
}  // namespace isthmus
