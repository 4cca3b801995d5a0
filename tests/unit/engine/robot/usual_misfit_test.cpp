#include "server/engine/robot/usual_misfit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace isthmus {
namespace {

// A thousand scans whose misfits are exponentially distributed.
UsualMisfit after_scans(double mean_misfit, int scans = 1000) {
  std::mt19937 random(1);
  std::exponential_distribution<double> misfit(1 / mean_misfit);
  UsualMisfit usual;
  for (int i = 0; i < scans; ++i) usual.learn(1 - misfit(random), {});
  return usual;
}

TEST(UsualMisfit, BeforeAnyScanAnyScoreIsUsual) { EXPECT_LT(UsualMisfit().least_score({}), 0); }

TEST(UsualMisfit, TheRareShareOfScansFitsWorse) {
  const UsualMisfit usual = after_scans(0.08);
  EXPECT_NEAR(usual.least_score({}), 1 - 0.08 * std::log(20), 0.03);
  std::mt19937 random(2);
  std::exponential_distribution<double> misfit(1 / 0.08);
  int worse = 0;
  for (int i = 0; i < 10'000; ++i) worse += 1 - misfit(random) < usual.least_score({}) ? 1 : 0;
  EXPECT_NEAR(worse, 500, 200);
}

TEST(UsualMisfit, FewScansTellLittle) {
  EXPECT_LT(after_scans(0.08, 5).least_score({}), 0.5);
  EXPECT_GT(after_scans(0.08, 100).least_score({}), 0.6);
}

TEST(UsualMisfit, OfOtherSurroundingsIsLearnedAnew) {
  UsualMisfit usual = after_scans(0.02);
  for (int i = 0; i < 2000; ++i) usual.learn(0.8, {});
  EXPECT_NEAR(usual.least_score({}), 1 - 0.2 * std::log(20), 0.02);
}

}  // namespace
}  // namespace isthmus
