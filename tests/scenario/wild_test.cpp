// Buildings that a seed draws: three of those that isthmus-campaign runs by the hundred.

#include "tools/simulate/wild/campaign.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace isthmus {
namespace {

void expect_no_failure(std::uint64_t seed) {
  const WildTrial trial = try_wild(seed);
  std::printf("seed %lu, %s: %zu relations, mean %.4f m, largest %.3f m, %.1f CPU s\n", seed,
              describe(draw_wild(seed)).c_str(), trial.score.relations, trial.score.mean_m, trial.score.max_m,
              trial.simulation_cpu_s + trial.cpu_s);
  EXPECT_GT(trial.score.relations, 100U);
  EXPECT_EQ(trial.score.missing, 0U);
  EXPECT_FALSE(trial.failed());
}

TEST(Wild, ACorridorWithOdometryThatSlipsJumpsAndJitters) { expect_no_failure(19); }

TEST(Wild, ARingOfOfficesWithOdometryThatSlipsInFastTurns) { expect_no_failure(12); }

TEST(Wild, TwoRobotsInWingsThatMeetThereAndBack) { expect_no_failure(24); }

TEST(Wild, IsMappedWithTheConfigurationThatItIsGiven) {
  Configuration sparse;
  sparse.engine.patch_spacing_m = 100;
  sparse.engine.uncovered_share = 1;
  const WildTrial trial = try_wild(19, {}, sparse), usual = try_wild(19);
  EXPECT_EQ(trial.scans, usual.scans) << "the run is the same";
  EXPECT_GT(trial.score.mean_m, usual.score.mean_m) << "and its map has fewer patches";
}

TEST(Wild, SeedsTriedInProcessesOfTheirOwnScoreTheSame) {
  std::vector<WildTrial> trials;
  try_seeds(
      19, 2, 2, [](std::uint64_t seed) { return try_wild(seed); },
      [&](const WildTrial& trial) { trials.push_back(trial); });
  ASSERT_EQ(trials.size(), 2U);
  for (const WildTrial& trial : trials) {
    const WildTrial alone = try_wild(trial.seed);
    EXPECT_TRUE(trial.finished);
    EXPECT_EQ(trial.scans, alone.scans);
    EXPECT_EQ(trial.score.relations, alone.score.relations);
    EXPECT_EQ(trial.score.mean_m, alone.score.mean_m);
  }
  EXPECT_EQ(trials[0].seed, 19U);
  EXPECT_EQ(trials[1].seed, 20U);
}

}  // namespace
}  // namespace isthmus
