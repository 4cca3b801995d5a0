#include "tools/simulate/campaigns/confidence/confidence.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

// Errors drawn from a covariance whose sigmas are `factor` times those claimed.
Confidence tally_of(double factor) {
  Eigen::Matrix3d covariance;
  covariance << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  const Eigen::Matrix3d root = covariance.llt().matrixL();
  Random random(1, "errors");
  ConfidenceTally tally;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d deviates(random.normal(), random.normal(), random.normal());
    tally.add(factor * root * deviates, covariance);
  }
  return tally.result();
}

TEST(ConfidenceTally, HonestCovariancesHoldTheTruthIn95PerCentAndHaveNeesOne) {
  const Confidence honest = tally_of(1);
  EXPECT_EQ(honest.pairs, 20000U);
  for (const double share : honest.within_95) EXPECT_NEAR(share, 0.95, 0.006);
  EXPECT_NEAR(honest.mean_nees, 1, 0.03);
  EXPECT_NEAR(honest.median_nees, 0.789, 0.03);
}

TEST(ConfidenceTally, FalseCertaintyShows) {
  const Confidence certain = tally_of(2);
  for (const double share : certain.within_95) EXPECT_NEAR(share, 0.673, 0.015);
  EXPECT_NEAR(certain.mean_nees, 4, 0.1);
}

TEST(ConfidenceTally, EmptyOneHasNoPairs) { EXPECT_EQ(ConfidenceTally{}.result().pairs, 0U); }

TEST(ConfidenceTally, SumsAreThoseOfAllPairs) {
  ConfidenceTally one, other;
  one.add({1, 0, 0}, Eigen::Matrix3d::Identity());
  other.add({0, 3, 0}, Eigen::Matrix3d::Identity());
  one.add(other);
  const Confidence both = one.result();
  EXPECT_EQ(both.pairs, 2U);
  EXPECT_EQ(both.within_95, (std::array<double, 3>{1, 0.5, 1}));
  EXPECT_NEAR(both.mean_nees, 10.0 / 3 / 2, 1e-12);
  EXPECT_NEAR(both.mean_error_m, 2, 1e-12);
}

}  // namespace
}  // namespace isthmus
