#include "scanmatch/features/line_fit.hpp"

#include <gtest/gtest.h>

#include <random>

namespace isthmus {
namespace {

BeamPoint at(double x, double y, double sigma_m) {
  return {{x, y}, sigma_m * sigma_m * Eigen::Matrix2d::Identity(), std::hypot(x, y), std::atan2(y, x), 0};
}

TEST(LineFit, VariancesAreThoseOfTheTextbook) {
  std::vector<BeamPoint> points;
  for (int i = -5; i <= 5; ++i) points.push_back(at(4, 0.1 * i, 0.02));
  const Line line = fit_line(points).value();
  EXPECT_TRUE(line.centre.isApprox(Eigen::Vector2d(4, 0)));
  EXPECT_TRUE(line.along.isApprox(Eigen::Vector2d(0, 1)));
  EXPECT_NEAR(line.rho_variance, 4e-4 / 11, 1e-12);
  EXPECT_NEAR(line.alpha_variance, 4e-4 / 1.1, 1e-12);  // Σ s² = 1.1 m²
  EXPECT_NEAR(line.chi_squared, 0, 1e-12);
}

TEST(LineFit, PointsThatAllErrAlikeTellNoMoreThanOne) {
  std::vector<BeamPoint> points;
  for (int i = -50; i <= 50; ++i) {
    points.push_back(at(4, 0.01 * i, 0.02));
    points.back().surface_variance = 4e-4;
    points.back().surface_reach_m = 1e6;
  }
  EXPECT_NEAR(fit_line(points)->rho_variance, 4e-4, 1e-5);
  for (BeamPoint& point : points) point.surface_reach_m = 0;
  EXPECT_NEAR(fit_line(points)->rho_variance, 4e-4 / 101, 1e-8);
}

/// Walls with a departure from straight that fades over 0.5 m, looked at head on by beams 2 cm apart.
TEST(LineFit, OnARoughWallErrsAsItSays) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  constexpr int walls = 400;
  double alpha = 0, rho = 0;
  for (int wall = 0; wall < walls; ++wall) {
    std::vector<BeamPoint> points;
    const double kept = std::exp(-0.02 / 0.5);
    double off = 0.01 * normal(random);
    for (int i = -100; i <= 100; ++i) {
      points.push_back(at(40 + off + 0.002 * normal(random), 0.02 * i, std::hypot(0.01, 0.002)));
      points.back().surface_variance = 1e-4;
      points.back().surface_reach_m = 0.5;
      off = kept * off + std::sqrt(1 - kept * kept) * 0.01 * normal(random);
    }
    const Line line = fit_line(points).value();
    const double turned = std::atan2(-line.along.x(), line.along.y());
    alpha += turned * turned / line.alpha_variance / walls;
    rho += std::pow(line.across_m({40, 0}), 2) / line.rho_variance / walls;
  }
  EXPECT_NEAR(alpha, 1, 0.25);
  EXPECT_NEAR(rho, 1, 0.25);
}

TEST(LineFit, APointCountsByItsVarianceAcrossTheLine) {
  const std::vector<BeamPoint> points{at(0, 0, 0.01), at(1, 0, 0.01), at(2, 0, 0.01), at(2, 0.3, 10)};
  const Line line = fit_line(points).value();
  EXPECT_NEAR(line.across_m({0, 0}), 0, 1e-5);
  EXPECT_NEAR(line.worst_sigmas, 0.03, 1e-3);
}

TEST(LineFit, OnePointOrOnePlaceIsNoLine) {
  EXPECT_FALSE(fit_line(std::vector<BeamPoint>{at(1, 1, 0.1)}));
  EXPECT_FALSE(fit_line(std::vector<BeamPoint>{at(1, 1, 0.1), at(1, 1, 0.1)}));
}

TEST(LineFit, ParallelLinesDoNotMeet) {
  const Line one = fit_line(std::vector<BeamPoint>{at(0, 0, 0.1), at(1, 0, 0.1)}).value();
  const Line other = fit_line(std::vector<BeamPoint>{at(0, 1, 0.1), at(1, 1, 0.1)}).value();
  const Line crossing = fit_line(std::vector<BeamPoint>{at(0.5, 3, 0.1), at(0.5, 4, 0.1)}).value();
  EXPECT_FALSE(meeting_point(one, other));
  EXPECT_TRUE(meeting_point(one, crossing).value().isApprox(Eigen::Vector2d(0.5, 0)));
}

}  // namespace
}  // namespace isthmus
