#include "patches/point_index.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/patch_scenes.hpp"

namespace isthmus {
namespace {

ScanPoint at(double x, double y) { return {{x, y}, {1, 0}, 0}; }

TEST(PointIndex, EmptyOneFindsNothing) {
  EXPECT_EQ(PointIndex().nearest({0, 0}), -1);
  EXPECT_EQ(PointIndex(std::vector<ScanPoint>{}).nearest({0, 0}), -1);
}

TEST(PointIndex, FindsTheNearerOfTwoPoints) {
  const std::vector<ScanPoint> points{at(0, 0), at(1, 0)};
  const PointIndex index(points);
  EXPECT_EQ(index.nearest({0.2, 0.1}), 0);
  EXPECT_EQ(index.nearest({0.9, -0.1}), 1);
}

TEST(PointIndex, PointsWithoutNormalAreNotInIt) {
  std::vector<ScanPoint> points{at(0, 0), at(0.3, 0)};
  points[0].normal.setZero();
  const PointIndex index(points);
  EXPECT_EQ(index.nearest({0, 0}), 1);
  points[1].normal.setZero();
  EXPECT_EQ(PointIndex(points).nearest({0, 0}), -1);
}

TEST(PointIndex, FarPositionsFindNothing) {
  const std::vector<ScanPoint> points{at(0, 0), at(30, 30)};
  const PointIndex index(points);
  EXPECT_EQ(index.nearest({15, 15}), -1) << "between tiles";
  EXPECT_EQ(index.nearest({0.65, 0}), -1) << "within the tile, beyond the reach";
  EXPECT_EQ(index.nearest({1e9, 0}), -1);
  EXPECT_EQ(index.nearest({-1e300, 1e300}), -1);
  EXPECT_EQ(index.nearest({std::nan(""), 0}), -1);
}

TEST(PointIndex, AbsurdlyFarPointsCostNoMemoryAndHideNoOthers) {
  const std::vector<ScanPoint> points{at(0, 0), at(1e9, -1e9), at(1e300, 0), at(std::nan(""), 0)};
  const PointIndex index(points);
  EXPECT_EQ(index.nearest({0, 0}), 0);
}

}  // namespace
}  // namespace isthmus
