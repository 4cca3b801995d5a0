#include "tests/scenario/simulated_maps.hpp"

namespace isthmus {
namespace {

// Long thin corridors with a door every 6 m: the first loop comes round 8 m off, so that what looks like the
// place where the robot is may well be the next door's.
TEST(SimulatedLongLoop, ScansCloseItWhereItIsAndNowhereElse) {
  const SimulatedMap loop = map_scenario("long_loop");
  const auto accepted = std::ranges::count_if(loop.map.closures, [](const ClosureRecord& closure) {
    return closure.state == ClosureState::accepted && closure.reason == Reason::from_scans;
  });
  const TrajectoryError error = judge_trajectories(loop);
  std::printf("long_loop: %td closures, mean error %.4f m, %.5f rad, at most %.3f m\n", accepted,
              error.mean_m, error.mean_rad, error.max_m);
  EXPECT_GE(accepted, 1);
  EXPECT_EQ(error.missing, 0U);
  EXPECT_LT(error.mean_m, 0.1);
  EXPECT_LT(error.max_m, 3);
  EXPECT_EQ(loop.map.graph.islands().size(), 1U);
}

// Nearly all that a laser sees from the middle of a street 26 m wide is more than 12 m away. The north street
// is driven twice, the middle one either way.
TEST(SimulatedCampus, IsMappedByWallsThatStandFarAway) {
  const SimulatedMap campus = map_scenario("campus");
  const TrajectoryError error = judge_trajectories(campus);
  std::printf("campus: mean error %.4f m, %.5f rad, at most %.3f m\n", error.mean_m, error.mean_rad,
              error.max_m);
  EXPECT_EQ(error.missing, 0U);
  EXPECT_LT(error.mean_m, 0.1);
  EXPECT_LT(error.max_m, 3);
  EXPECT_EQ(campus.map.graph.islands().size(), 1U);
}

}  // namespace
}  // namespace isthmus
