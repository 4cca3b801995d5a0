#include "patches/ring.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace isthmus {
namespace {

const Ring unit_square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

double loops_area(const std::vector<Ring>& loops) {
  double area = 0;
  for (const Ring& loop : loops) area += std::abs(signed_area_m2(loop));
  return area;
}

TEST(Ring, AreaIsSignedByOrientation) {
  EXPECT_DOUBLE_EQ(signed_area_m2(unit_square), 1);
  EXPECT_DOUBLE_EQ(signed_area_m2(Ring(unit_square.rbegin(), unit_square.rend())), -1);
  EXPECT_EQ(signed_area_m2({}), 0);
}

TEST(Ring, EnclosesByEvenOddRule) {
  EXPECT_TRUE(encloses(unit_square, {0.5, 0.5}));
  EXPECT_FALSE(encloses(unit_square, {1.5, 0.5}));
  EXPECT_FALSE(encloses(unit_square, {0.5, std::nan("")}));
  EXPECT_FALSE(encloses({}, {0, 0}));
}

TEST(Ring, SegmentsThatCrossMeetAtTheCrossing) {
  const Meeting meeting = meet({0, 0}, {2, 2}, {0, 2}, {2, 0});
  EXPECT_EQ(meeting.kind, Meeting::crossing);
  EXPECT_NEAR((meeting.at - Eigen::Vector2d(1, 1)).norm(), 0, 1e-12);
}

TEST(Ring, SegmentsThatEndOnOneAnotherTouch) {
  const Meeting meeting = meet({0, 0}, {2, 0}, {1, 0}, {1, 5});
  EXPECT_EQ(meeting.kind, Meeting::touching);
  EXPECT_EQ(meeting.at, Eigen::Vector2d(1, 0));
}

TEST(Ring, CollinearSegmentsTouchOnlyWhereTheyOverlap) {
  EXPECT_EQ(meet({0, 0}, {2, 1}, {1, 0.5}, {4, 2}).kind, Meeting::touching);
  EXPECT_EQ(meet({0, 0}, {2, 1}, {4, 2}, {6, 3}).kind, Meeting::apart);
}

TEST(Ring, SegmentsWhoseLinesCrossElsewhereAreApart) {
  EXPECT_EQ(meet({0, 0}, {1, 0}, {0.5, 0.1}, {0.5, 3}).kind, Meeting::apart);
}

TEST(Ring, SquareIsSimple) {
  EXPECT_TRUE(is_simple(unit_square));
  EXPECT_TRUE(is_simple({{0, 0}, {0.5, 0}, {1, 0}, {1, 1}})) << "a straight point is no fold";
}

TEST(Ring, DegenerateRingsAreNotSimple) {
  const double nan = std::nan("");
  EXPECT_FALSE(is_simple({}));
  EXPECT_FALSE(is_simple({{0, 0}, {1, 0}}));
  EXPECT_FALSE(is_simple({{0, 0}, {1, 0}, {2, 0}})) << "no area";
  EXPECT_FALSE(is_simple({{0, 0}, {1, 0}, {1, 0}, {1, 1}})) << "a repeated point";
  EXPECT_FALSE(is_simple({{0, 0}, {1, 0}, {1, 1}, {0, 0}})) << "the first point at the end again";
  EXPECT_FALSE(is_simple({{0, 0}, {2, 0}, {1, 0}, {1, 1}})) << "a fold";
  EXPECT_FALSE(is_simple({{0, 0}, {1, 1}, {1, 0}, {0, 1}})) << "a bow tie";
  EXPECT_FALSE(is_simple({{0, 0}, {nan, 1}, {1, 0}, {0, 1}}));
  EXPECT_FALSE(is_simple({{0, 0}, {1e7, 0}, {1e7, 1e7}}));
}

TEST(Ring, SimpleRingIsItsOnlyLoop) {
  const auto loops = simple_loops(unit_square);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0], unit_square);
}

TEST(Ring, RepeatedPointsAndSpikesGo) {
  // A spike out of the right side, and points given twice.
  const auto loops =
      simple_loops({{0, 0}, {0, 0}, {1, 0}, {1, 0.5}, {3, 0.5}, {1, 0.5}, {1, 1}, {0, 1}, {0, 0}});
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_NEAR(std::abs(signed_area_m2(loops[0])), 1, 1e-9);
  EXPECT_TRUE(is_simple(loops[0]));
}

TEST(Ring, NonFinitePointsGo) {
  const double inf = std::numeric_limits<double>::infinity();
  const auto loops = simple_loops({{0, 0}, {1, 0}, {inf, 0.5}, {1, 1}, {std::nan(""), 0}, {0, 1}});
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_NEAR(std::abs(signed_area_m2(loops[0])), 1, 1e-9);
}

TEST(Ring, BowTieFallsIntoTwoTriangles) {
  const auto loops = simple_loops({{0, 0}, {1, 1}, {1, 0}, {0, 1}});
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_NEAR(loops_area(loops), 0.5, 1e-9);
}

TEST(Ring, RingThatPassesAPointTwiceIsPartedThere) {
  // A square frame closed at one corner of its hole: an outer ring and an inner one of opposite sense.
  const auto loops = simple_loops({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 2}, {2, 2}, {2, 1}});
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_LT(signed_area_m2(loops[0]) * signed_area_m2(loops[1]), 0);
}

TEST(Ring, LoopsWithoutAreaGo) {
  EXPECT_TRUE(simple_loops({}).empty());
  EXPECT_TRUE(simple_loops({{1, 1}, {1, 1}, {1, 1}}).empty());
  EXPECT_TRUE(simple_loops({{0, 0}, {1, 0}, {2, 0}, {1, 0}}).empty());
  EXPECT_TRUE(simple_loops({{0, 0}, {1e-4, 0}, {0, 1e-4}}).empty());
}

TEST(Ring, HopelessTangleIsDroppedInBoundedTime) {
  Ring star;
  for (int i = 0; i < 1001; ++i) star.emplace_back(std::cos(i * 3.0), std::sin(i * 3.0));
  EXPECT_TRUE(simple_loops(star).empty());
}

TEST(Ring, StraightPointsGo) {
  const Ring ring = without_straight_points({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {0, 2}, {0, 1}}, 1e-9);
  EXPECT_EQ(ring, Ring({{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
}

TEST(Ring, SimplifiedChainKeepsCornersAndEnds) {
  const std::vector<Eigen::Vector2d> chain{{0, 0}, {1, 0.01}, {2, 0}, {3, 0}, {3, 1}, {3.01, 2}, {3, 3}};
  EXPECT_EQ(simplify_chain(chain, 0.05, 100), (std::vector<std::size_t>{0, 3, 6}));
  EXPECT_EQ(simplify_chain(chain, 0.05, 2), (std::vector<std::size_t>{0, 2, 3, 4, 6}));
  EXPECT_TRUE(simplify_chain({}, 0.05, 100).empty());
}

}  // namespace
}  // namespace isthmus
