#include "server/output/vector_plan/vector_plan.hpp"

#include <gtest/gtest.h>

#include "tests/support/plan_scenes.hpp"

namespace isthmus {
namespace {

using testing::fan;
using testing::pole_seen;
using testing::wall_seen;

void expect_near(const Eigen::Vector2d& point, double x, double y, double tolerance) {
  EXPECT_NEAR(point.x(), x, tolerance);
  EXPECT_NEAR(point.y(), y, tolerance);
}

TEST(VectorPlan, PiecesOfOneWallAreOneWall) {
  // Seen from above: a is on the observer's right. Each is off by a centimetre or so.
  PlanSource source;
  source.segments = {wall_seen(0, {4, 0.01}, {0, 0}), wall_seen(1, {7, -0.01}, {3, 0}),
                     wall_seen(2, {10, 0}, {6, 0.01}), wall_seen(3, {10, 0}, {0, 0.005})};
  const VectorPlan plan = fit_plan(source, {});
  ASSERT_EQ(plan.walls.size(), 1u);
  expect_near(plan.walls[0].a, 10, 0, 0.02);
  expect_near(plan.walls[0].b, 0, 0, 0.02);
  EXPECT_EQ(plan.walls[0].views, 4);
}

TEST(VectorPlan, TheFacesOfAWallStayTwo) {
  PlanSource source;
  for (int view = 0; view < 3; ++view) source.segments.push_back(wall_seen(view, {5, 0}, {0, 0}));
  for (int view = 3; view < 6; ++view) source.segments.push_back(wall_seen(view, {0, -0.05}, {5, -0.05}));
  const VectorPlan plan = fit_plan(source, {});
  ASSERT_EQ(plan.walls.size(), 2u);
  EXPECT_NEAR(std::abs(plan.walls[0].a.y() - plan.walls[1].a.y()), 0.05, 1e-6);
}

TEST(VectorPlan, AWallThatStandsBackIsAnother) {
  PlanSource source;
  for (int view = 0; view < 3; ++view) {
    source.segments.push_back(wall_seen(view, {5, 0}, {0, 0}));
    source.segments.push_back(wall_seen(view, {11, -0.2}, {6, -0.2}));
  }
  EXPECT_EQ(fit_plan(source, {}).walls.size(), 2u);
}

/// Two pieces of one wall, 1 m apart, seen by two scans from above.
PlanSource wall_with_gap(bool ends_known) {
  PlanSource source;
  for (int view = 0; view < 2; ++view) {
    source.segments.push_back(wall_seen(view, {4, 0}, {0, 0}, ends_known, false));
    source.segments.push_back(wall_seen(view, {9, 0}, {5, 0}, false, ends_known));
  }
  return source;
}

TEST(VectorPlan, AGapThatScansLookedThroughIsAnOpening) {
  PlanSource source = wall_with_gap(true);
  for (const double x : {4.2, 4.8}) source.views.push_back(fan({x, 2}, {4, -1}, {5, -1}));
  const VectorPlan plan = fit_plan(source, {});
  ASSERT_EQ(plan.walls.size(), 2u);
  ASSERT_EQ(plan.openings.size(), 1u);
  expect_near(plan.openings[0].a, 5, 0, 0.01);
  expect_near(plan.openings[0].b, 4, 0, 0.01);
}

TEST(VectorPlan, AGapThatNobodyLookedThroughIsNoOpening) {
  PlanSource source = wall_with_gap(true);
  source.views = {fan({4.5, 2}, {4, 0}, {5, 0}), fan({4.5, 3}, {4, 0}, {5, 0})};  // they end in it
  EXPECT_TRUE(fit_plan(source, {}).openings.empty());
}

TEST(VectorPlan, WithoutViewsAnOpeningIsBetweenKnownEnds) {
  EXPECT_EQ(fit_plan(wall_with_gap(true), {}).openings.size(), 1u);
  EXPECT_TRUE(fit_plan(wall_with_gap(false), {}).openings.empty());
}

TEST(VectorPlan, WhatMoreScansLookThroughThanSeeIsNoWall) {
  PlanSource source;
  for (int view = 0; view < 2; ++view) source.segments.push_back(wall_seen(view, {4, 0}, {0, 0}));
  for (const double x : {0.5, 2.0, 3.5}) source.views.push_back(fan({x, 2}, {-8, -2}, {12, -2}));
  EXPECT_TRUE(fit_plan(source, {}).walls.empty());
}

TEST(VectorPlan, WallsThatNearlyMeetDoMeet) {
  PlanSource source;
  for (int view = 0; view < 3; ++view) {
    source.segments.push_back(wall_seen(view, {4, 0}, {0.3, 0}));    // ends 0.3 m before the corner
    source.segments.push_back(wall_seen(view, {0, -0.04}, {0, 3}));  // reaches a little too far
  }
  const VectorPlan plan = fit_plan(source, {});
  ASSERT_EQ(plan.walls.size(), 2u);
  expect_near(plan.walls[0].b, 0, 0, 1e-6);
  expect_near(plan.walls[1].a, 0, 0, 1e-6);
}

TEST(VectorPlan, ShortThingsSeenOnceAreNoWalls) {
  PlanSource source;
  source.segments = {wall_seen(0, {0.4, 0}, {0, 0}), wall_seen(1, {5, 2}, {3, 2})};
  const VectorPlan plan = fit_plan(source, {});
  ASSERT_EQ(plan.walls.size(), 1u);
  EXPECT_NEAR(plan.walls[0].a.y(), 2, 1e-9);
}

TEST(VectorPlan, APoleIsWhatIsSeenOftenAndNotLookedThrough) {
  PlanSource source;
  for (int view = 0; view < 4; ++view) {
    source.poles.push_back(pole_seen(view, {1 + 0.01 * view, 1}, 0.2));
    source.poles.push_back(pole_seen(view, {4, 1}, 0.1));  // somebody who went away
  }
  source.poles.push_back(pole_seen(4, {7, 1}, 0.1));
  for (int view = 0; view < 5; ++view) source.views.push_back(fan({4, -2}, {3.5, 4}, {4.5, 4}));
  const VectorPlan plan = fit_plan(source, {});
  ASSERT_EQ(plan.poles.size(), 1u);
  expect_near(plan.poles[0].centre, 1.015, 1, 1e-9);
  EXPECT_NEAR(plan.poles[0].radius_m, 0.2, 1e-9);
  EXPECT_NEAR(plan.poles[0].sigma_m, 0.005, 1e-9);
  EXPECT_EQ(plan.poles[0].views, 4);
}

}  // namespace
}  // namespace isthmus
