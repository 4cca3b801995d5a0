#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

#include "server/output/vector_plan/plan_files.hpp"
#include "server/output/vector_plan/wall_fit.hpp"
#include "tests/property/drawn.hpp"
#include "tests/support/plan_scenes.hpp"

namespace isthmus {
namespace {

using testing::between;
using testing::fan;
using testing::pole_seen;
using testing::wall_seen;

Eigen::Vector2d arbitrary_point() { return {between(-20, 20), between(-20, 20)}; }

/// Any segments, poles and beams.
PlanSource arbitrary_source() {
  PlanSource source;
  const int segments = *rc::gen::inRange(0, 40), views = *rc::gen::inRange(0, 4);
  for (int i = 0; i < segments; ++i) {
    const Eigen::Vector2d a = arbitrary_point();
    const double yaw = between(-3.14, 3.14), length = between(0.3, 8);
    source.segments.push_back(wall_seen(*rc::gen::inRange(0, 5), a,
                                        a + length * Eigen::Vector2d(std::cos(yaw), std::sin(yaw)),
                                        *rc::gen::arbitrary<bool>(), *rc::gen::arbitrary<bool>()));
  }
  for (int i = 0; i < segments / 4; ++i)
    source.poles.push_back(pole_seen(*rc::gen::inRange(0, 5), arbitrary_point(), between(0.02, 0.5)));
  for (int i = 0; i < views; ++i)
    source.views.push_back(fan(arbitrary_point(), arbitrary_point(), arbitrary_point()));
  return source;
}

bool lies_near(const Eigen::Vector2d& point, const PlanSource& source, double reach_m) {
  return std::any_of(source.segments.begin(), source.segments.end(), [&](const FeatureSeen& seen) {
    const Feature& wall = seen.observed.feature;
    const double at = std::clamp(along(wall).dot(point - wall.a), 0.0, length_m(wall));
    return (wall.a + at * along(wall) - point).norm() < reach_m;
  });
}

TEST(VectorPlanProperty, WallsAreFiniteAndWhereSomethingWasSeen) {
  EXPECT_TRUE(rc::check([] {
    const PlanSource source = arbitrary_source();
    const PlanOptions options;
    const double reach_m = options.stretches.corner_reach_m + options.stretches.close_gap_m + 0.2;
    for (const PlanWall& wall : fit_plan(source, options).walls) {
      RC_ASSERT(wall.a.allFinite());
      RC_ASSERT(wall.b.allFinite());
      RC_ASSERT(wall.sigma_m > 0);
      RC_ASSERT(wall.views >= 1);
      RC_ASSERT(lies_near(wall.a, source, reach_m));
      RC_ASSERT(lies_near(wall.b, source, reach_m));
    }
  }));
}

TEST(VectorPlanProperty, FittingLosesNoSegmentAndTakesNoneTwice) {
  EXPECT_TRUE(rc::check([] {
    const PlanSource source = arbitrary_source();
    std::vector<int> taken(source.segments.size(), 0);
    for (const FittedWall& wall : fit_walls(source.segments, {}))
      for (const std::size_t segment : wall.segments) ++taken[segment];
    for (const int times : taken) RC_ASSERT(times == 1);
  }));
}

TEST(VectorPlanProperty, OneWallIsOneWhereverItLies) {
  // Pieces of a wall with 1 cm of noise, seen from anywhere on the plane at any heading.
  EXPECT_TRUE(rc::check([] {
    const Pose place{between(-1000, 1000), between(-1000, 1000), between(-3.14, 3.14)};
    PlanSource source;
    const int count = *rc::gen::inRange(3, 30);
    source.segments.push_back(wall_seen(0, place * Eigen::Vector2d(0, 0), place * Eigen::Vector2d(12, 0)));
    for (int view = 1; view < count; ++view) {
      const double from = between(0, 8), off = between(-0.015, 0.015);
      source.segments.push_back(wall_seen(view, place * Eigen::Vector2d(from, off),
                                          place * Eigen::Vector2d(from + between(2, 4), off)));
    }
    const std::vector<FittedWall> walls = fit_walls(source.segments, {});
    RC_ASSERT(walls.size() == 1u);
    RC_ASSERT(std::abs(walls[0].line.half_m - 6) < 0.05);
    RC_ASSERT(std::abs(walls[0].line.across_m(place * Eigen::Vector2d(6, 0))) < 0.02);
  }));
}

TEST(VectorPlanProperty, TheSamePlanIsDrawnTwice) {
  EXPECT_TRUE(rc::check([] {
    const PlanSource source = arbitrary_source();
    RC_ASSERT(plan_geojson(fit_plan(source, {}), "") == plan_geojson(fit_plan(source, {}), ""));
  }));
}

}  // namespace
}  // namespace isthmus
