#include "server/engine/annotations/polygon_check.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace isthmus {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

TEST(PolygonCheck, TakesRingsWithAnInside) {
  EXPECT_TRUE(is_simple(Ring{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_TRUE(is_simple(Ring{{0, 0}, {0, 1}, {1, 0}})) << "whichever way round";
  EXPECT_TRUE(is_simple(Ring{{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}})) << "a corner on a straight side";
  EXPECT_TRUE(is_simple(Ring{{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}}));
}

TEST(PolygonCheck, RefusesRingsThatMeetThemselves) {
  EXPECT_FALSE(is_simple(Ring{{0, 0}, {1, 0}}));
  EXPECT_FALSE(is_simple(Ring{{0, 0}, {2, 2}, {2, 0}, {0, 2}})) << "sides that cross";
  EXPECT_FALSE(is_simple(Ring{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}})) << "a corner on a side";
  EXPECT_FALSE(is_simple(Ring{{0, 0}, {2, 0}, {1, 0}, {1, 1}})) << "a way back";
  EXPECT_FALSE(is_simple(Ring{{0, 0}, {1, 0}, {1, 0}, {0, 1}})) << "a corner twice";
  EXPECT_FALSE(is_simple(Ring{{0, 0}, {1, 0}, {2, 0}})) << "no area";
}

TEST(PolygonCheck, MeasuresArea) {
  EXPECT_NEAR(signed_area_m2(Ring{{1000, 0}, {1002, 0}, {1002, 3}, {1000, 3}}), 6, 1e-9);
  EXPECT_NEAR(signed_area_m2(Ring{{0, 0}, {0, 3}, {2, 3}, {2, 0}}), -6, 1e-9);
}

// Also where a fit has bent it so that it crosses itself.
TEST(PolygonCheck, AllThatARingGoesAroundIsInside) {
  const Ring bow = {{0, 0}, {2, 2}, {2, 0}, {0, 2}};
  EXPECT_TRUE(is_inside(bow, {0.2, 1}));
  EXPECT_TRUE(is_inside(bow, {1.8, 1}));
  EXPECT_FALSE(is_inside(bow, {1, 1.8}));
  const Ring twice = {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0}, {3, 0}, {3, 3}, {0, 3}};
  EXPECT_TRUE(is_inside(twice, {1, 1})) << "gone around twice";
}

}  // namespace
}  // namespace isthmus
