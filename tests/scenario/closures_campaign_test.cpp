#include "tools/simulate/closures_campaign.hpp"

#include <gtest/gtest.h>

#include "tools/simulate/scenario_file.hpp"

// Buildings of which one place looks like another: no relation may say that they are one.

namespace isthmus {
namespace {

void expect_no_wrong_closures(const std::string& scenario, std::uint64_t seeds, double most_error_m) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const ClosureTrial trial = try_closures(load_scenario(scenario), seed);
    EXPECT_EQ(trial.score.wrong_closures, 0U) << scenario << " " << seed;
    EXPECT_EQ(trial.score.wrong_merges, 0U) << scenario << " " << seed;
    EXPECT_LT(trial.mean_error_m, most_error_m) << scenario << " " << seed;
    EXPECT_GT(trial.score.relations, 100U);
    EXPECT_GT(trial.compared, 100U);
  }
}

TEST(ClosuresCampaign, IdenticalRooms) { expect_no_wrong_closures("repeated_rooms", 2, 0.2); }

TEST(ClosuresCampaign, ParallelCorridors) { expect_no_wrong_closures("long_corridors", 2, 3); }

TEST(ClosuresCampaign, TwoWingsOfOnePlan) {
  expect_no_wrong_closures("two_wings", 2, 0.2);
  expect_no_wrong_closures("two_wings_pair", 2, 0.2);
  expect_no_wrong_closures("two_wings_apart", 2, 0.2);
}

}  // namespace
}  // namespace isthmus
