#include "server/engine/map/drift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace isthmus {
namespace {

// What errs the same way all along adds up: standard deviations grow with the way, and not with its root.
TEST(SystematicVariance, GrowsWithTheSquareOfTheWay) {
  const auto sigma = [](double way_m) { return Eigen::Vector3d(systematic_variance(way_m, {}).cwiseSqrt()); };
  EXPECT_TRUE((sigma(200) - sigma(100)).isApprox(sigma(100) - sigma(0), 1e-9));
  EXPECT_GT(sigma(100).x(), sigma(0).x() + 1) << "more than a per cent";
  EXPECT_EQ(sigma(100).x(), sigma(100).y());
}

// The bounds of drift are as many standard deviations as a window's: 1 m and three tenths of the way.
TEST(DriftVariance, IsOfTheBoundsOfDrift) {
  const double sigmas = CommonOptions{}.window_sigmas;
  EXPECT_NEAR(sigmas * std::sqrt(drift_variance(20, {}).x()), 7, 1e-9);
  EXPECT_NEAR(sigmas * std::sqrt(drift_variance(20, {}).y()), 7, 1e-9);
  EXPECT_NEAR(sigmas * std::sqrt(drift_variance(20, {}).z()), 1.0 / 6 + 0.12, 1e-9);
}

// Of a way of 200 m.
double odds(const Pose& off, const Eigen::Matrix3d& covariance = Eigen::Matrix3d::Zero()) {
  const Pose mapped{7, -4, 2};
  return revisit_log_odds({mapped.x + off.x, mapped.y + off.y, mapped.yaw + off.yaw}, mapped, covariance, 200,
                          {});
}

TEST(RevisitLogOdds, AreHighWhereTheMapHadThePlace) {
  // Gaussian at its peak times the window: sigmas 2.6 m and 0.113 rad, half widths 61 m and 1.37 rad.
  const double sigma_rad = 0.2 / 6 + 0.08, half_rad = 1.0 / 6 + 1.2;
  EXPECT_NEAR(odds({}),
              std::log(0.95 * 4 * 61 * 61 * 2 * half_rad /
                           (2 * std::numbers::pi * 2.6 * 2.6 * std::sqrt(2 * std::numbers::pi) * sigma_rad) +
                       0.05),
              1e-6);
  EXPECT_GT(odds({}), odds({3, 0, 0}));
  EXPECT_GT(odds({3, 0, 0}), odds({0, 6, 0}));
  EXPECT_GT(odds({3, 0, 0}), odds({3, 0, 0.2}));
  EXPECT_NEAR(odds({3, 0, 0.1}), odds({0, -3, -0.1}), 1e-9);
}

// Wheels slip once in twenty ways, and then the map may be off by anything.
TEST(RevisitLogOdds, AreThoseOfASlipHoweverFarOffTheMapWas) {
  EXPECT_NEAR(odds({40, 20, 1}), std::log(0.05), 1e-6);
  EXPECT_NEAR(odds({0, 0, 3}), std::log(0.05), 1e-6);
}

// Where the map itself says that it hardly knows, being elsewhere surprises less and being there says less.
TEST(RevisitLogOdds, FollowTheCovariance) {
  const Eigen::Matrix3d wide = Eigen::Vector3d(100, 1, 0.01).asDiagonal();
  EXPECT_GT(odds({15, 0, 0}, wide), odds({15, 0, 0}) + 3);
  EXPECT_LT(odds({}, wide), odds({}) - 1);
  EXPECT_LT(odds({0, 15, 0}, wide), odds({15, 0, 0}, wide) - 3) << "wide along x only";
}

}  // namespace
}  // namespace isthmus
