#include "patches/segment.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(Segment, APointIsAsFarAsTheNearestOfTheSegmentIs) {
  const Eigen::Vector2d a(1, 1), b(4, 5);
  EXPECT_EQ(nearest_on_segment({-2, 1}, a, b), a) << "before its beginning";
  EXPECT_EQ(nearest_on_segment({4, 9}, a, b), b) << "beyond its end";
  EXPECT_NEAR(distance_to_segment_m({4, 9}, a, b), 4, 1e-12);
  const Eigen::Vector2d aside = a + 0.3 * (b - a) + Eigen::Vector2d(-0.8, 0.6);
  EXPECT_TRUE(nearest_on_segment(aside, a, b).isApprox(a + 0.3 * (b - a)));
  EXPECT_NEAR(distance_to_segment_m(aside, a, b), 1, 1e-12);
}

TEST(Segment, OfNoLengthIsAPoint) {
  EXPECT_EQ(nearest_on_segment({3, 4}, {0, 0}, {0, 0}), Eigen::Vector2d(0, 0));
  EXPECT_EQ(distance_to_segment_m({3, 4}, {0, 0}, {0, 0}), 5);
}

}  // namespace
}  // namespace isthmus
