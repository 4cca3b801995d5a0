#include <gtest/gtest.h>

#include "patches/star.hpp"
#include "random_solids.hpp"
#include "tests/property/drawn.hpp"

namespace isthmus {
namespace {

using testing::any_laser;
using testing::any_scan;
using testing::between;

FreeSpaceOptions unsimplified() {
  FreeSpaceOptions options;
  options.no_return_range_m = 2;
  options.outline.simplify_tolerance_m = 0;
  return options;
}

TEST(FreeSpaceProperty, RingsAreSimpleAndCounterClockwise) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid free = free_space_of(any_scan(), any_laser(), {});
    for (const PolygonWithHoles& polygon : free.polygons()) {
      RC_ASSERT(is_simple(polygon.outer));
      RC_ASSERT(signed_area_m2(polygon.outer) > 0);
      RC_ASSERT(polygon.holes.empty());
    }
  }));
}

TEST(FreeSpaceProperty, AreaIsThatOfTheWedgesBetweenUsableBeams) {
  EXPECT_TRUE(rc::check([] {
    const Scan scan = any_scan();
    const Laser laser = any_laser();
    const auto free_m = [&](std::size_t i) {
      const BeamKind kind = classify(scan.ranges_m[i], laser);
      if (kind == BeamKind::ignored) return 0.0;
      return kind == BeamKind::hit ? std::min(static_cast<double>(scan.ranges_m[i]), 20.0) : 2.0;
    };
    const std::size_t n = scan.ranges_m.size();
    const double step_rad = std::abs(scan.bearing_step_rad);
    const bool closed = std::abs(static_cast<double>(n) * step_rad - 2 * std::numbers::pi) < 1e-9 && n > 2;
    double wedges_m2 = 0;
    for (std::size_t i = 0; i + 1 < n + (closed ? 1 : 0); ++i) {
      wedges_m2 += 0.5 * free_m(i) * free_m((i + 1) % n) * std::sin(step_rad);
    }
    RC_ASSERT(std::abs(testing::area_m2(free_space_of(scan, laser, unsimplified())) - wedges_m2) < 1e-3);
  }));
}

TEST(FreeSpaceProperty, SimplifyingMovesTheBoundaryByNoMoreThanTheTolerance) {
  EXPECT_TRUE(rc::check([] {
    const Scan scan = any_scan();
    const Laser laser = any_laser();
    FreeSpaceOptions options = unsimplified();
    const Polysolid full = free_space_of(scan, laser, options);
    options.outline.simplify_tolerance_m = 0.05;
    const Polysolid simple = free_space_of(scan, laser, options);
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d point(between(-10, 10), between(-10, 10));
      if (testing::distance_to_boundary(full, point) < 0.051) continue;
      RC_ASSERT(contains(full, point) == contains(simple, point));
    }
  }));
}

// The star takes the nearest beam, the polysolid the wedge between two: they must agree wherever the two
// neighbouring beams do, short of the chord between them.
TEST(FreeSpaceProperty, StarAgreesWithPolysolid) {
  EXPECT_TRUE(rc::check([] {
    const Scan scan = any_scan();
    RC_PRE(std::abs(scan.bearing_step_rad) < 0.5);
    const Laser laser = any_laser();
    const FreeSpaceOptions options = unsimplified();
    const Polysolid free = free_space_of(scan, laser, options);
    const Star star(scan, laser, options.max_range_m, options.no_return_range_m);
    const auto free_m = [&](std::size_t i) {
      const BeamKind kind = classify(scan.ranges_m[i], laser);
      if (kind == BeamKind::ignored) return 0.0;
      return kind == BeamKind::hit ? std::min(static_cast<double>(scan.ranges_m[i]), 20.0) : 2.0;
    };
    for (std::size_t i = 0; i + 1 < scan.ranges_m.size(); ++i) {
      const double near_m = std::min(free_m(i), free_m(i + 1));
      const double far_m = std::max(free_m(i), free_m(i + 1));
      const double share = between(0.02, 0.98);
      const double bearing = scan.bearing0_rad + (static_cast<double>(i) + share) * scan.bearing_step_rad;
      const Eigen::Vector2d along(std::cos(bearing), std::sin(bearing));
      // Within the chord between the shorter of both beams.
      const double inside_m = 0.98 * near_m * std::cos(0.5 * scan.bearing_step_rad);
      if (near_m > 0.05) {
        RC_ASSERT(star.contains(laser.robot_from_laser * (inside_m * along)));
        RC_ASSERT(contains(free, laser.robot_from_laser * (inside_m * along)));
      }
      if (far_m > 0) {
        RC_ASSERT(!star.contains(laser.robot_from_laser * (1.02 * far_m * along)));
        RC_ASSERT(!contains(free, laser.robot_from_laser * (1.02 * far_m * along)));
      }
    }
  }));
}

}  // namespace
}  // namespace isthmus
