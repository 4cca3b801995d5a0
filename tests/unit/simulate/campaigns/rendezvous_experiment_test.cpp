#include "tools/simulate/campaigns/features/rendezvous_experiment.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(RendezvousExperiment, MapsAreOfThePapersSizeAndTheirDuplicatesAreFound) {
  std::vector<RendezvousScore> scores;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    scores.push_back(judge_fusion(run_rendezvous_experiment(seed)));
    const RendezvousScore& score = scores.back();
    EXPECT_NEAR(static_cast<double>(score.corners_1), 95, 6) << seed;
    EXPECT_NEAR(static_cast<double>(score.corners_2), 60, 6) << seed;
    EXPECT_NEAR(static_cast<double>(score.duplicates), 31, 6) << seed;
    EXPECT_EQ(score.wrong, 0U) << seed;
    EXPECT_GT(score.before_3_sigma_m, 10) << seed;
    EXPECT_LT(score.after_3_sigma_m, 0.6) << seed;
  }
  const RendezvousScore mean = mean_of(scores);
  EXPECT_GE(static_cast<double>(mean.found), 0.95 * static_cast<double>(mean.duplicates));
  EXPECT_LT(mean.nees_after, 2);
}

TEST(RendezvousExperiment, ErrorsAreAsSmallAsTheExperimentPermits) {
  for (const double corner_sigma_m : {0.0, 0.03}) {
    const RendezvousConditions conditions{corner_sigma_m, 1, false};
    const RendezvousScore score = judge_fusion(run_rendezvous_experiment(1, conditions));
    const double least = least_3_sigma_m(1, conditions);
    EXPECT_EQ(score.found, score.duplicates);
    EXPECT_LT(score.after_3_sigma_m, 1.05 * least) << corner_sigma_m;
    EXPECT_GT(score.after_3_sigma_m, 0.95 * least) << corner_sigma_m;
  }
}

TEST(RendezvousExperiment, ASeedGivesTheSameRun) {
  const RendezvousExperiment one = run_rendezvous_experiment(3), again = run_rendezvous_experiment(3);
  EXPECT_EQ(one.one.covariance, again.one.covariance);
  EXPECT_EQ(one.alignment.one_from_two, again.alignment.one_from_two);
}

}  // namespace
}  // namespace isthmus
