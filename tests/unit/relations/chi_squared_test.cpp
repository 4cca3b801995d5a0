#include "relations/chi_squared.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace isthmus {
namespace {

TEST(ChiSquared, QuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(chi2_quantile(0.95, 1), 3.841, 5e-4);
  EXPECT_NEAR(chi2_quantile(0.999, 1), 10.828, 5e-4);
  EXPECT_NEAR(chi2_quantile(0.99, 2), 9.210, 5e-4);
  EXPECT_NEAR(chi2_quantile(0.999, 2), 13.816, 5e-4);
  EXPECT_NEAR(chi2_quantile(0.95, 3), 7.815, 5e-4);
  EXPECT_NEAR(chi2_quantile(0.999, 3), 16.266, 5e-4);
}

TEST(ChiSquared, WithOneDegreeOfFreedomTheyAreSquaredSigmasOfANormal) {
  for (const double sigmas : {1.0, 2.0, 3.0, 5.0})
    EXPECT_NEAR(chi2_quantile(std::erf(sigmas / std::sqrt(2.0)), 1), sigmas * sigmas, 1e-6 * sigmas * sigmas);
}

TEST(ChiSquared, WhatIsNoProbabilityIsAnError) {
  EXPECT_THROW(chi2_quantile(-0.1, 3), std::domain_error);
  EXPECT_THROW(chi2_quantile(1.1, 3), std::domain_error);
  EXPECT_THROW(chi2_quantile(0.95, 0), std::domain_error);
}

TEST(ChiSquared, ATestHasTheBoundsOfItsProbability) {
  const ChiSquaredTest test(0.95);
  EXPECT_EQ(test.probability(), 0.95);
  for (const int degrees : {1, 2, 3}) EXPECT_EQ(test.bound(degrees), chi2_quantile(0.95, degrees));
  for (const int degrees : {-1, 0, 4}) EXPECT_THROW(test.bound(degrees), std::out_of_range);
}

}  // namespace
}  // namespace isthmus
