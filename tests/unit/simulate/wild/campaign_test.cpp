#include "tools/simulate/wild/campaign.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace isthmus {
namespace {

WildTrial finished(std::uint64_t seed, std::size_t scans = 0) {
  WildTrial trial;
  trial.seed = seed;
  trial.finished = true;
  trial.scans = scans;
  return trial;
}

TEST(WildCampaign, SeedsComeInTheirOrderHoweverManyRunAtATime) {
  for (const unsigned jobs : {1U, 3U}) {
    std::vector<WildTrial> trials;
    const auto attempt = [](std::uint64_t seed) { return finished(seed, 2 * seed); };
    try_seeds(5, 7, jobs, attempt, [&](const WildTrial& trial) { trials.push_back(trial); });
    ASSERT_EQ(trials.size(), 7U);
    for (std::size_t i = 0; i < trials.size(); ++i) {
      EXPECT_EQ(trials[i].seed, 5 + i);
      EXPECT_EQ(trials[i].scans, 2 * (5 + i));
      EXPECT_FALSE(trials[i].failed());
    }
  }
}

TEST(WildCampaign, AProcessThatFailsIsARunThatFailedAndDoesNotStopTheOthers) {
  std::vector<WildTrial> trials;
  const auto attempt = [](std::uint64_t seed) -> WildTrial {
    if (seed == 2) throw std::runtime_error("as the test wants it");
    return finished(seed);
  };
  try_seeds(1, 3, 2, attempt, [&](const WildTrial& trial) { trials.push_back(trial); });
  ASSERT_EQ(trials.size(), 3U);
  EXPECT_FALSE(trials[0].failed());
  EXPECT_TRUE(trials[1].failed());
  EXPECT_EQ(trials[1].seed, 2U);
  EXPECT_FALSE(trials[2].failed());
}

TEST(WildTraits, AreComparedBetweenTheRunsThatFailedAndTheOthers) {
  std::vector<WildTrial> trials(40);
  std::size_t frozen = 0;
  for (std::uint64_t seed = 0; seed < trials.size(); ++seed) {
    const auto traits = traits_of(draw_wild(seed));
    const bool holds = std::ranges::find(traits, "freezes", &WildTrait::name)->holds;
    trials[seed] = finished(seed);
    trials[seed].score.max_m = holds ? 2 : 0;
    frozen += holds ? 1U : 0U;
  }
  ASSERT_GT(frozen, 0U);
  const auto shares = compare_traits(trials);
  EXPECT_EQ(shares.front().name, "freezes");
  EXPECT_NEAR(shares.front().of_failed, 1, 1e-9);
  EXPECT_NEAR(shares.front().of_others, 0, 1e-9);
}

}  // namespace
}  // namespace isthmus
