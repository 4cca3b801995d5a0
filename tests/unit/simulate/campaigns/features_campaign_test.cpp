#include "tools/simulate/campaigns/features/features.hpp"

#include <gtest/gtest.h>

#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

/// A room of 4 m by 3 m, its surfaces as lines.
FloorPlan room_of_lines() {
  Building building;
  building.walls = {{{{0, 0}, {4, 0}, {4, 3}, {0, 3}}, true, {}}};
  building.wall_thickness_m = 0;
  return build_floor_plan(building);
}

FeatureState map_with(const Feature& wall) {
  FeatureState state;
  add_robot(state, {}, Eigen::Matrix3d::Zero());
  const int q = dimension(wall);
  add_feature(state, 0, {wall, 1e-4 * LocalMatrix::Identity(q, q)});
  return state;
}

TEST(FeaturesCampaign, ATrueWallHasNoError) {
  FeatureColumn column;
  const Pose world_from_map{1, 1, 0.7};
  judge_walls(map_with(inverse(world_from_map) * segment_feature({4, 0}, {4, 2}, true, false)),
              room_of_lines(), world_from_map, column);
  EXPECT_EQ(column.features, 1);
  EXPECT_EQ(column.endpoints, 1);
  EXPECT_EQ(column.matched, 1);
  EXPECT_NEAR(column.alpha_deg + column.rho_m + column.middle_m + column.endpoint_m, 0, 1e-6);
}

TEST(FeaturesCampaign, AWallThatIsOffIsToldByHowMuch) {
  FeatureColumn column;
  judge_walls(map_with(segment_feature({4.1, 0.2}, {4.1, 3}, true, true)), room_of_lines(), {}, column);
  EXPECT_NEAR(column.rho_m, 0.1, 1e-9);
  EXPECT_NEAR(column.middle_m, 0.1, 1e-9);
  EXPECT_NEAR(column.alpha_deg, 0, 1e-6);
  EXPECT_NEAR(column.endpoint_m, 0.5 * (std::hypot(0.1, 0.2) + 0.1), 1e-9);
}

// Far from the frame's origin a wall that is turned by little has a ρ that is off by much, and lies where it
// is.
TEST(FeaturesCampaign, AMiddleIsNoFartherOffForLyingFarFromTheOrigin) {
  FeatureColumn column;
  const Pose world_from_map{4, -40, 0};
  const Feature turned = segment_feature({4 - 0.01, 0.5}, {4 + 0.01, 1.5}, true, true);
  judge_walls(map_with(inverse(world_from_map) * turned), room_of_lines(), world_from_map, column);
  EXPECT_NEAR(column.middle_m, 0, 1e-9);
  EXPECT_NEAR(column.rho_m, 41 * 0.02, 0.01);
}

TEST(FeaturesCampaign, AWallWhereNoneIsCountsAsNotMatched) {
  FeatureColumn column;
  judge_walls(map_with(segment_feature({2, 1}, {2, 2}, false, false)), room_of_lines(), {}, column);
  EXPECT_EQ(column.features, 1);
  EXPECT_EQ(column.matched, 0);
}

/// Three minutes of the courtyards: both robots map their way, meet, and go on in one map.
TEST(FeaturesCampaign, RobotsThatMeetMapTheCourtyardsToADecimetre) {
  Scenario scenario = load_scenario("courtyards", {"roughness_m=0", "duration_s=180"});
  scenario.robots.resize(2);
  FeatureCampaignOptions options;
  options.surface_sigma_m = 0.001;
  const FeatureTrial trial = try_features(simulate(scenario, 1), scenario.plan, 1, options);
  ASSERT_TRUE(trial.met_s.has_value());
  for (std::size_t k = 0; k < trial.columns.size(); ++k) {
    ASSERT_TRUE(trial.columns[k].has_value()) << feature_column_names[k];
    EXPECT_LT(trial.columns[k]->position_m, 0.12) << feature_column_names[k];
    EXPECT_LT(trial.columns[k]->orientation_deg, 0.25) << feature_column_names[k];
    EXPECT_GT(trial.columns[k]->features, 60) << feature_column_names[k];
    EXPECT_LT(trial.columns[k]->nees, 2) << feature_column_names[k];
  }
  EXPECT_GT(trial.columns[2]->features, 1.3 * trial.columns[0]->features);
  EXPECT_EQ(mean_of({trial}, FeatureColumnId::s1).position_m, trial.columns[0]->position_m);
}

/// They meet where their ways cross first: of two maps of 80 and 74 walls one or two are the same, too little
/// to be sure of. When each has come to where the other was, about twenty are.
TEST(FeaturesCampaign, MapsThatOverlapShareTheirWalls) {
  Scenario scenario = load_scenario("courtyards", {"roughness_m=0", "duration_s=255"});
  scenario.robots.resize(2);
  FeatureCampaignOptions options;
  options.surface_sigma_m = 0.001;
  options.meet_after_s = 250;
  for (std::uint64_t seed = 2; seed <= 3; ++seed) {
    const FeatureTrial trial = try_features(simulate(scenario, seed), scenario.plan, seed, options);
    EXPECT_GE(trial.duplicates, 15U) << seed;
    EXPECT_LE(trial.duplicates, 30U) << seed;
    for (const FeatureColumnId id : {FeatureColumnId::m1, FeatureColumnId::m2})
      EXPECT_LT(trial.columns[static_cast<std::size_t>(id)]->position_m, 0.12) << seed;
  }
}

TEST(FeaturesCampaign, OneRobotAloneIsAnError) {
  Scenario scenario = load_scenario("courtyards", {"duration_s=2"});
  scenario.robots.resize(1);
  EXPECT_THROW(try_features(simulate(scenario, 1), scenario.plan, 1, {}), std::runtime_error);
}

}  // namespace
}  // namespace isthmus
