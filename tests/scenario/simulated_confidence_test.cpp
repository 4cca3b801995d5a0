#include "tests/scenario/simulated_maps.hpp"

namespace isthmus {
namespace {

void print(const char* what, const Confidence& c) {
  std::printf(
      "%-10s %6zu pairs, 95 %% intervals hold x %.1f %%, y %.1f %%, yaw %.1f %%; NEES per degree of freedom "
      "%.3f, median %.3f\n",
      what, c.pairs, 100 * c.within_95[0], 100 * c.within_95[1], 100 * c.within_95[2], c.mean_nees,
      c.median_nees);
}

// Loose bounds, that only gross over- or underconfidence breaks; isthmus-campaign measures with more runs.
void expect_sane(const Confidence& c) {
  EXPECT_GT(c.pairs, 100U);
  for (const double share : c.within_95) EXPECT_GT(share, 0.75);
  EXPECT_LT(c.mean_nees, 4);
  EXPECT_GT(c.mean_nees, 0.01);
}

TEST(SimulatedConfidence, TruthLiesWhereTheCovariancesSay) {
  MapConfidence all;
  for (const char* scenario : {"campaign_flat", "campaign_depot", "campaign_gallery"}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const SimulatedMap simulated = map_scenario(scenario, {}, seed);
      const MapConfidence one = judge_confidence(simulated.map, simulated.run.truth, EngineOptions{});
      all.local.add(one.local);
      all.island.add(one.island);
      all.undetermined += one.undetermined;
    }
  }
  print("local map", all.local.result());
  print("island", all.island.result());
  EXPECT_EQ(all.undetermined, 0U);
  expect_sane(all.local.result());
  expect_sane(all.island.result());
}

}  // namespace
}  // namespace isthmus
