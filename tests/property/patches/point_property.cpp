#include <gtest/gtest.h>

#include "patches/point_index.hpp"
#include "random_solids.hpp"
#include "tests/property/drawn.hpp"

namespace isthmus {
namespace {

using testing::any_laser;
using testing::any_scan;
using testing::between;

TEST(PointProperty, NormalsAreUnitAndFaceTheLaser) {
  EXPECT_TRUE(rc::check([] {
    const Laser laser = any_laser();
    const Eigen::Vector2d eye(laser.robot_from_laser.x, laser.robot_from_laser.y);
    for (const ScanPoint& point : to_points(any_scan(), laser, {})) {
      RC_ASSERT(point.position.allFinite());
      if (!point.has_normal()) {
        RC_ASSERT(point.normal.isZero());
        continue;
      }
      RC_ASSERT(std::abs(point.normal.norm() - 1) < 1e-9);
      RC_ASSERT(point.normal.dot(eye - point.position) >= -1e-12);
    }
  }));
}

TEST(PointProperty, PointsLieAtTheirRangesAlongTheirBeams) {
  EXPECT_TRUE(rc::check([] {
    const Scan scan = any_scan();
    const Laser laser = any_laser();
    std::size_t hits = 0;
    for (const float range_m : scan.ranges_m) hits += classify(range_m, laser) == BeamKind::hit ? 1 : 0;
    const auto points = to_points(scan, laser, {});
    RC_ASSERT(points.size() == hits);
    for (const ScanPoint& point : points) {
      const Eigen::Vector2d in_laser = inverse(laser.robot_from_laser) * point.position;
      const auto beam = static_cast<std::size_t>(point.beam);
      RC_ASSERT(std::abs(in_laser.norm() - static_cast<double>(scan.ranges_m[beam])) < 1e-4);
      const double bearing = scan.bearing0_rad + point.beam * scan.bearing_step_rad;
      RC_ASSERT(std::abs(wrap_angle(std::atan2(in_laser.y(), in_laser.x()) - bearing)) < 1e-6);
    }
  }));
}

// The nearest point by brute force, against which the index may lose a cell's diagonal: half of it at the
// query's end and half at the point's.
TEST(PointProperty, IndexFindsTheNearestToWithinACell) {
  EXPECT_TRUE(rc::check([] {
    std::vector<ScanPoint> points(static_cast<std::size_t>(*rc::gen::inRange(1, 60)));
    for (ScanPoint& point : points) {
      point.position = {between(-4, 4), between(-4, 4)};
      point.normal = *rc::gen::inRange(0, 5) == 0 ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(1, 0);
    }
    const PointIndex index(points);
    const double diagonal_m = PointIndex::cell_m * std::numbers::sqrt2;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector2d query(between(-6, 6), between(-6, 6));
      double nearest_m = std::numeric_limits<double>::infinity();
      for (const ScanPoint& point : points) {
        if (point.has_normal()) nearest_m = std::min(nearest_m, (point.position - query).norm());
      }
      const int found = index.nearest(query);
      if (nearest_m < PointIndex::reach_m - diagonal_m) RC_ASSERT(found >= 0);
      if (nearest_m > PointIndex::reach_m + diagonal_m) RC_ASSERT(found < 0);
      if (found < 0) continue;
      const ScanPoint& point = points[static_cast<std::size_t>(found)];
      RC_ASSERT(point.has_normal());
      RC_ASSERT((point.position - query).norm() <= nearest_m + diagonal_m);
    }
  }));
}

}  // namespace
}  // namespace isthmus
