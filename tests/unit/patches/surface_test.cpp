#include "patches/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "patches/point_index.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// Of a wall along y.
ScanPoint end_at(double x, double y, int beam) { return {{x, y}, {-1, 0}, beam}; }

TEST(BetweenBeams, AWallGoesOnBetweenTheEndsOfNeighbouringBeams) {
  const std::vector<ScanPoint> points{end_at(30, 0, 7), end_at(30.05, 1, 8), end_at(30, 1.1, 9)};
  const std::vector<SurfacePoint> between = between_beams(points, 0.22);
  ASSERT_EQ(between.size(), 4U);
  EXPECT_TRUE(between[0].position.isApprox(Eigen::Vector2d(30.01, 0.2))) << between[0].position.transpose();
  EXPECT_TRUE(between[3].position.isApprox(Eigen::Vector2d(30.04, 0.8))) << between[3].position.transpose();
  EXPECT_EQ(between[1].point, 0U) << "the nearer end";
  EXPECT_EQ(between[2].point, 1U);
}

TEST(BetweenBeams, NothingIsBetweenEndsOnDifferentSurfaces) {
  const ScanPoint first = end_at(30, 0, 7);
  ScanPoint corner = end_at(30, 1, 8);
  corner.normal = {0, 1};
  ScanPoint without_line = end_at(30, 1, 8);
  without_line.normal.setZero();
  ScanPoint back = end_at(30, 1, 8);
  back.normal = -back.normal;
  const ScanPoint niche = end_at(30.3, 1, 8);
  for (const ScanPoint& other : {corner, without_line, back, niche}) {
    EXPECT_TRUE(between_beams(std::vector{first, other}, 0.2).empty());
    EXPECT_TRUE(between_beams(std::vector{other, first}, 0.2).empty());
  }
}

// What a beam between two ends says decides, and where it came back from nowhere there may be an opening.
TEST(BetweenBeams, NothingIsSaidOfWhereABeamDidNotComeBack) {
  const std::vector<ScanPoint> points{end_at(30, 0, 7), end_at(30, 1, 9), end_at(30, 2, 10)};
  const std::vector<SurfacePoint> between = between_beams(points, 0.5);
  ASSERT_EQ(between.size(), 1U);
  EXPECT_TRUE(between[0].position.isApprox(Eigen::Vector2d(30, 1.5)));
}

TEST(BetweenBeams, EveryOtherBeamLeftOutIsNoOpening) {
  const std::vector<ScanPoint> points{end_at(30, 0, 6), end_at(30, 1, 8), end_at(30, 2, 10)};
  EXPECT_EQ(between_beams(points, 0.5).size(), 2U);
}

TEST(BetweenBeams, EndsTooFarApartHaveNothingBetween) {
  EXPECT_TRUE(between_beams(std::vector{end_at(30, 0, 7), end_at(30, 4.1, 8)}, 0.2).empty());
  EXPECT_TRUE(between_beams(std::vector<ScanPoint>{}, 0.2).empty());
}

// The house across a street of 30 m shows a beam each half a metre and more.
TEST(BetweenBeams, IndexFindsALineWhereverOnAFarWallABeamEnds) {
  const Walls wall{{{30, -20}, {30, 20}}};
  const std::vector<ScanPoint> points = to_points(scan_from(wall, {}, 0, 80), laser_of(80), {});
  const PointIndex index(points);
  const auto [low, high] =
      std::ranges::minmax(points, {}, [](const ScanPoint& point) { return point.position.y(); });
  const double length_m = high.position.y() - low.position.y();
  ASSERT_GT(length_m, 38);
  for (double share = 0.05; share < 0.95; share += 0.001) {
    const Eigen::Vector2d at(30.05, low.position.y() + share * length_m);
    const int found = index.nearest(at);
    ASSERT_GE(found, 0) << at.transpose();
    EXPECT_LT(std::abs(points[static_cast<std::size_t>(found)].position.y() - at.y()), 0.6);
  }
}

}  // namespace
}  // namespace isthmus
