#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "server/feature_maps/feature_estimator.hpp"
#include "server/feature_maps/feature_files.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/simulate/run/simulation.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

TEST(FeatureMaps, FourRobotsInTheOfficeComeToOneAccurateMapOfSegments) {
  const SimulatedRun run = simulate(load_scenario("office", {}), 1);
  FeatureEstimator estimator(feature_map_options(FeatureMapKind::segments));
  for (const Event& event : run.events) estimator.handle(event);
  Outcome outcome;
  estimator.finish_step(outcome);
  const FeatureMaps maps = estimator.maps();
  ASSERT_EQ(maps.teams.size(), 1u);
  std::map<std::pair<std::string, std::int64_t>, Pose> truth;
  for (const RobotTruth& robot : run.truth)
    for (const TruePose& pose : robot.poses) truth[{robot.robot, pose.utime}] = pose.world_from_robot;
  std::vector<PosePair> pairs;
  for (const Journey& journey : maps.journeys)
    for (const JourneyRow& row : journey.rows)
      if (const auto found = truth.find({journey.robot, row.utime}); found != truth.end())
        pairs.push_back({found->second, row.map_from_robot});
  ASSERT_GT(pairs.size(), 5000u);
  const Pose truth_from_map = align(pairs);
  double mean_m = 0;
  for (const PosePair& pair : pairs)
    mean_m += (position(truth_from_map * pair.map_from_robot) - position(pair.truth_from_robot)).norm() /
              static_cast<double>(pairs.size());
  EXPECT_LT(mean_m, 0.012);
  EXPECT_LT(features_csv(maps).size(), 60'000u);
}

}  // namespace
}  // namespace isthmus
