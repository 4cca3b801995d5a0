#include "tests/scenario/simulated_maps.hpp"

namespace isthmus {
namespace {

// Driving where one has been adds nothing: the map follows area, not time.
void expect_no_growth(const std::string& scenario) {
  const SimulatedMap once = map_scenario(scenario, {"laps=1"});
  const SimulatedMap often = map_scenario(scenario, {"laps=10"});
  const auto patches_once = static_cast<double>(once.map.patches.size());
  const auto patches_often = static_cast<double>(often.map.patches.size());
  std::printf("%s: %g patches once, %g after ten laps\n", scenario.c_str(), patches_once, patches_often);
  EXPECT_GT(patches_once, 3);
  EXPECT_LE(patches_often, std::ceil(1.05 * patches_once));
  EXPECT_EQ(often.map.graph.islands().size(), 1U);

  const TrajectoryError error = judge_trajectories(often);
  std::printf("%s: mean error %.4f m, %.5f rad, at most %.3f m\n", scenario.c_str(), error.mean_m,
              error.mean_rad, error.max_m);
  EXPECT_GT(error.relations, 100U);
  EXPECT_EQ(error.missing, 0U);
  EXPECT_LT(error.mean_m, 0.03);
  EXPECT_LT(error.max_m, 0.2);
}

TEST(SimulatedLaps, TenTimesToAndFroAddNothingToTheMapOfOnce) { expect_no_growth("to_and_fro"); }

TEST(SimulatedLaps, TenTimesRoundALoopAddNothingToTheMapOfOnce) { expect_no_growth("loop"); }

}  // namespace
}  // namespace isthmus
