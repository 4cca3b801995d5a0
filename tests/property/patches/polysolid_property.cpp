#include <gtest/gtest.h>

#include "random_solids.hpp"

namespace isthmus {
namespace {

using testing::any_free_space;
using testing::any_pose;
using testing::any_solid;
using testing::between;
using testing::distance_to_boundary;
using testing::garbage_ring;

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
    const Polysolid both = unite(a, b);
    expect_sound(both);
    expect_near(area_m2(subtract(a, both)), 0);
    expect_near(area_m2(subtract(b, both)), 0);
  }));
}

TEST(PolysolidProperty, AreasObeyInclusionAndExclusion) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_solid();
    const Polysolid b = any_solid();
    expect_near(area_m2(unite(a, b)) + area_m2(intersect(a, b)), area_m2(a) + area_m2(b));
  }));
}

TEST(PolysolidProperty, DifferenceAndIntersectionPartASolid) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_solid();
    const Polysolid b = any_solid();
    const Polysolid outside = subtract(a, b);
    const Polysolid inside = intersect(a, b);
    expect_sound(outside);
    expect_sound(inside);
    expect_near(area_m2(outside) + area_m2(inside), area_m2(a));
    expect_near(area_m2(intersect(outside, inside)), 0);
    expect_near(area_m2(unite(outside, inside)), area_m2(a));
  }));
}

TEST(PolysolidProperty, UnionIsCommutativeAssociativeAndIdempotent) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_solid();
    const Polysolid b = any_solid();
    const Polysolid c = any_solid();
    expect_near(area_m2(unite(a, a)), area_m2(a));
    expect_near(area_m2(unite(a, b)), area_m2(unite(b, a)));
    const double area = area_m2(unite(unite(a, b), c));
    expect_near(area, area_m2(unite(a, unite(b, c))));
    expect_near(area, area_m2(unite({a, b, c})));
  }));
}

TEST(PolysolidProperty, MembershipFollowsTheSetOperations) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_solid();
    const Polysolid b = any_solid();
    const Polysolid both = unite(a, b);
    const Polysolid common = intersect(a, b);
    const Polysolid rest = subtract(a, b);
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d point(between(-10, 10), between(-10, 10));
      if (std::min(distance_to_boundary(a, point), distance_to_boundary(b, point)) < 1e-3) continue;
      const bool in_a = contains(a, point);
      const bool in_b = contains(b, point);
      RC_ASSERT(contains(both, point) == (in_a || in_b));
      RC_ASSERT(contains(common, point) == (in_a && in_b));
      RC_ASSERT(contains(rest, point) == (in_a && !in_b));
    }
  }));
}

TEST(PolysolidProperty, OverlapMeansSharedArea) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid a = any_free_space();
    const Polysolid b = any_free_space();
    const double shared_m2 = area_m2(intersect(a, b));
    const bool overlaps = overlap(a, b);
    RC_TAG(overlaps);
    RC_ASSERT(overlaps == overlap(b, a));
    if (shared_m2 > area_tolerance_m2) RC_ASSERT(overlaps);
    if (overlaps && shared_m2 == 0) {
      // What the intersection dropped was a sliver: moving one of them apart by a hair loses it or keeps it.
      RC_ASSERT(area_m2(subtract(a, b)) >= area_m2(a) - area_tolerance_m2);
    }
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
    expect_near(area_m2(intersect(moved_a, moved_b)), area_m2(intersect(a, b)));
    expect_near(area_m2(unite(moved_a, moved_b)), area_m2(unite(a, b)));
    expect_near(area_m2(subtract(transformed(inverse(motion), moved_a), a)), 0);
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

TEST(PolysolidProperty, OperationsOnUncheckedGarbageGiveSoundSolids) {
  EXPECT_TRUE(rc::check([] {
    const Polysolid garbage = Polysolid::of_sound({{garbage_ring(), {garbage_ring()}}, {garbage_ring(), {}}});
    const Polysolid square({{{{-1, -1}, {5, -1}, {5, 5}, {-1, 5}}, {}}});
    const Polysolid space = unite(square, any_free_space());
    expect_sound(unite(garbage, space));
    expect_near(area_m2(unite(garbage, space)), area_m2(space));
    expect_sound(intersect(garbage, space));
    expect_sound(subtract(space, garbage));
    expect_sound(unite({garbage, space, garbage}));
    overlap(garbage, space);
    to_wkt(garbage);
  }));
}

}  // namespace
}  // namespace isthmus
