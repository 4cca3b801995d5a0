#include "scanmatch/features/line_fit.hpp"

#include <gtest/gtest.h>

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
