#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "server/feature_maps/feature_estimator.hpp"
#include "server/feature_maps/output/feature_files.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/simulate/run/simulation.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

FeatureMaps map_by_segments(const std::vector<Event>& events) {
  FeatureEstimator estimator(feature_map_options(FeatureMapKind::segments));
  for (const Event& event : events) estimator.handle(event);
  Outcome outcome;
  estimator.finish_step(outcome);
  return estimator.maps();
}

/// What is left where no robot recognises another.
std::vector<Event> without_sightings(std::vector<Event> events) {
  std::erase_if(events, [](const Event& event) { return std::holds_alternative<SightingEvent>(event.body); });
  return events;
}

/// Of the way of all robots, one map's frame aligned with the truth as a whole.
double mean_error_m(const FeatureMaps& maps, const SimulatedRun& run) {
  std::map<std::pair<std::string, std::int64_t>, Pose> truth;
  for (const RobotTruth& robot : run.truth)
    for (const TruePose& pose : robot.poses) truth[{robot.robot, pose.utime}] = pose.world_from_robot;
  std::vector<PosePair> pairs;
  for (const Journey& journey : maps.journeys)
    for (const JourneyRow& row : journey.rows)
      if (const auto found = truth.find({journey.robot, row.utime}); found != truth.end())
        pairs.push_back({found->second, row.map_from_robot});
  EXPECT_GT(pairs.size(), 5000u);
  const Pose truth_from_map = align(pairs);
  double sum_m = 0;
  for (const PosePair& pair : pairs)
    sum_m += (position(truth_from_map * pair.map_from_robot) - position(pair.truth_from_robot)).norm();
  return sum_m / static_cast<double>(pairs.size());
}

TEST(FeatureMaps, FourRobotsInTheOfficeComeToOneAccurateMapOfSegments) {
  const SimulatedRun run = simulate(load_scenario("office", {}), 1);
  const FeatureMaps maps = map_by_segments(run.events);
  ASSERT_EQ(maps.teams.size(), 1u);
  EXPECT_LT(mean_error_m(maps, run), 0.012);
  EXPECT_LT(features_csv(maps).size(), 60'000u);
}

TEST(FeatureMaps, FourRobotsThatNeverSeeOneAnotherComeToOneMapByItsWalls) {
  const SimulatedRun run = simulate(load_scenario("office", {}), 11);
  const FeatureMaps maps = map_by_segments(without_sightings(run.events));
  ASSERT_EQ(maps.teams.size(), 1u);
  EXPECT_LT(mean_error_m(maps, run), 0.05);
}

TEST(FeatureMaps, HalvesOfABuildingThatLookAlikeAreNotTakenForOne) {
  const SimulatedRun run = simulate(load_scenario("spiral_of_two_halves", {}), 11);
  const FeatureMaps maps = map_by_segments(without_sightings(run.events));
  EXPECT_GT(maps.teams.size(), 1u);
  for (const FusionRecord& fusion : maps.fusions) EXPECT_NE(fusion.state, FusionState::accepted);
}

}  // namespace
}  // namespace isthmus
