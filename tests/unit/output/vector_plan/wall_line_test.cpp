#include "server/output/vector_plan/wall_line.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace isthmus {
namespace {

WallLine line(const Eigen::Vector2d& middle, double yaw_rad, double half_m, double alpha_sigma,
              double rho_sigma) {
  WallLine result;
  result.middle = middle;
  result.along = {std::cos(yaw_rad), std::sin(yaw_rad)};
  result.half_m = half_m;
  result.covariance.diagonal() << alpha_sigma * alpha_sigma, rho_sigma * rho_sigma;
  result.covariance(0, 1) = result.covariance(1, 0) = 0;
  return result;
}

TEST(WallLine, TwoLinesDifferByTurnAndStepInTheMiddleOfTheGapBetweenThem) {
  // The second begins 2 m after the end of the first, 3 cm to the observer's side at its middle, turned by
  // 0.01.
  const WallLine one = line({0, 0}, 0, 1, 1e-3, 1e-2), other = line({4, 0.03}, 0.01, 1, 1e-3, 1e-2);
  const LineDifference apart = difference(one, other);
  EXPECT_NEAR(apart.turn_rad, 0.01, 1e-12);
  EXPECT_NEAR(apart.gap_m, 2, 1e-3);
  EXPECT_NEAR(apart.step_m, -0.03 + 2 * std::tan(0.01), 1e-6);  // across points away from the observer
  EXPECT_NEAR(apart.covariance(1, 1), 2 * (1e-4 + 4 * 1e-6), 1e-7);
}

TEST(WallLine, JoinedLiesBetweenTwoEquallyGoodOnesAndIsTwiceAsSure) {
  const WallLine one = line({0, 0}, 0, 1, 1e-2, 1e-2), other = line({0, 0.02}, 0, 2, 1e-2, 1e-2);
  const WallLine both = joined(one, other);
  EXPECT_NEAR(both.across_m({0, 0}), 0.01, 1e-12);
  EXPECT_NEAR(both.half_m, 2, 1e-12);
  EXPECT_NEAR(both.covariance(0, 0), 0.5e-4, 1e-12);
  EXPECT_NEAR(both.covariance(1, 1), 0.5e-4, 1e-12);
}

TEST(WallLine, TwoSurePlacesFarApartTellTheDirection) {
  // Neither knows its direction; together they do: from 10 m apart, each 1 cm, to 1.4 mrad.
  const WallLine one = line({0, 0}, 0, 0.5, 0.3, 0.01), other = line({10, 0.1}, 0, 0.5, 0.3, 0.01);
  const WallLine both = joined(one, other);
  EXPECT_NEAR(std::atan2(both.along.y(), both.along.x()), 0.01, 1e-4);
  EXPECT_NEAR(std::sqrt(both.covariance(0, 0)), std::sqrt(2.0) * 1e-3, 1e-5);
}

TEST(WallLine, JoiningIsTheSameFromEitherSide) {
  const WallLine one = line({1, 2}, 0.5, 1, 1e-2, 1e-2), other = line({3.4, 3.3}, 0.52, 2, 2e-3, 2e-2);
  const WallLine a = joined(one, other), b = joined(other, one);
  EXPECT_NEAR((a.middle - b.middle).norm(), 0, 2e-4);
  EXPECT_NEAR((a.along - b.along).norm(), 0, 2e-4);
  EXPECT_NEAR((a.covariance - b.covariance).norm() / a.covariance.norm(), 0, 1e-2);
}

}  // namespace
}  // namespace isthmus
