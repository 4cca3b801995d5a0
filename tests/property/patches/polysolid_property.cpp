#include <gtest/gtest.h>

#include "random_solids.hpp"
#include "tests/property/drawn.hpp"
#include "tests/support/solids.hpp"

namespace isthmus {
namespace {

using testing::any_free_space;
using testing::any_pose;
using testing::any_solid;
using testing::area_m2;
using testing::between;
using testing::distance_to_boundary;
using testing::garbage_ring;
using testing::shared_area_m2;
using testing::united;

// Dropped slivers (min_ring_area_m2 each) and points moved by rounding.
constexpr double area_tolerance_m2 = 2e-4;

void expect_near(double a, double b) { RC_ASSERT(std::abs(a - b) < area_tolerance_m2); }

void expect_sound(const Polysolid& solid) {
  for (const PolygonWithHoles& polygon : solid.polygons()) {
    RC_ASSERT(is_simple(polygon.outer));
    RC_ASSERT(signed_area_m2(polygon.outer) > 0);
    for (const Ring& hole : polygon.holes) {
      RC_ASSERT(is_simple(hole));
      RC_ASSERT(signed_area_m2(hole) < 0);
    }
  }
}

TEST(PolysolidProperty, UnionHoldsBothParts) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_solid();
    const Polysolid b = any_solid();
    const Polysolid both = united({a, b});
    expect_sound(both);
    expect_near(shared_area_m2(a, both), area_m2(a));
    expect_near(shared_area_m2(b, both), area_m2(b));
    RC_ASSERT(area_m2(both) < area_m2(a) + area_m2(b) + area_tolerance_m2);
  }));
}

TEST(PolysolidProperty, UnionIsCommutativeAssociativeAndIdempotent) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_solid();
    const Polysolid b = any_solid();
    const Polysolid c = any_solid();
    expect_near(area_m2(united({a, a})), area_m2(a));
    expect_near(area_m2(united({a, b})), area_m2(united({b, a})));
    const double area = area_m2(united({united({a, b}), c}));
    expect_near(area, area_m2(united({a, united({b, c})})));
    expect_near(area, area_m2(united({a, b, c})));
  }));
}

TEST(PolysolidProperty, MembershipFollowsTheUnion) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_solid();
    const Polysolid b = any_solid();
    const Polysolid both = united({a, b});
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d point(between(-10, 10), between(-10, 10));
      if (std::min(distance_to_boundary(a, point), distance_to_boundary(b, point)) < 1e-3) continue;
      RC_ASSERT(contains(both, point) == (contains(a, point) || contains(b, point)));
    }
  }));
}

TEST(PolysolidProperty, OverlapMeansSharedArea) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_free_space();
    const Polysolid b = any_free_space();
    const double shared_m2 = shared_area_m2(a, b);
    const bool overlaps = overlap(a, b);
    RC_TAG(overlaps);
    RC_ASSERT(overlaps == overlap(b, a));
    if (shared_m2 > area_tolerance_m2) RC_ASSERT(overlaps);  // what is shared and less may be a sliver
    RC_ASSERT(overlap(a, a) == !a.empty());
    RC_ASSERT(!overlap(a, transformed({1000, 0, 0}, b)));
  }));
}

TEST(PolysolidProperty, RigidMotionsChangeNoAreaAndNoRelation) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_solid();
    const Polysolid b = any_solid();
    const Pose motion = any_pose(100);
    const Polysolid moved_a = transformed(motion, a);
    const Polysolid moved_b = transformed(motion, b);
    expect_near(area_m2(moved_a), area_m2(a));
    expect_near(area_m2(united({moved_a, moved_b})), area_m2(united({a, b})));
    expect_near(shared_area_m2(transformed(inverse(motion), moved_a), a), area_m2(a));
    const Eigen::Vector2d point(between(-10, 10), between(-10, 10));
    if (distance_to_boundary(a, point) > 1e-6) {
      RC_ASSERT(contains(a, point) == contains(moved_a, motion * point));
    }
  }));
}

TEST(PolysolidProperty, GarbageRingIsItsEvenOddInterior) {
  EXPECT_TRUE(rc::check([] {
    const Ring ring = garbage_ring();
    const Polysolid repaired({{ring, {}}});
    expect_sound(repaired);
    const Polysolid raw = Polysolid::of_sound({{ring, {}}});
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d point(between(-0.5, 4.5), between(-0.5, 4.5));
      if (distance_to_boundary(raw, point) < 2e-3) continue;
      RC_ASSERT(contains(repaired, point) == encloses(ring, point));
    }
  }));
}

TEST(PolysolidProperty, UnionsOfUncheckedGarbageAreSound) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid garbage = Polysolid::of_sound({{garbage_ring(), {garbage_ring()}}, {garbage_ring(), {}}});
    const Polysolid square({{{{-1, -1}, {5, -1}, {5, 5}, {-1, 5}}, {}}});
    const Polysolid space = united({square, any_free_space()});
    expect_sound(united({garbage, space}));
    expect_near(area_m2(united({garbage, space})), area_m2(space));
    expect_sound(united({garbage, space, garbage}));
    overlap(garbage, space);
    to_wkt(garbage);
  }));
}

}  // namespace
}  // namespace isthmus
