#include <gtest/gtest.h>

#include "tools/simulate/campaigns/floor_plans/floor_plans.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

TEST(FloorPlan, OfTheSimulatedOfficeShowsItsWallsWhereTheyAre) {
  const PlanScore score = try_floor_plan(load_scenario("office", {}), 1);
  EXPECT_LT(score.rms_m, 0.02);
  EXPECT_GT(score.walls_found_share, 0.95);
  EXPECT_LT(score.false_share, 0.01);
  EXPECT_EQ(score.poles, 2u);  // its pillars
  EXPECT_LT(score.walls, 200u);
}

}  // namespace
}  // namespace isthmus
