#include "server/exploration/timed_way.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

const TimedWay& round_a_corner() {
  static const TimedWay way({{0, 0}, {2, 0}, {2, 0}, {2, 3}}, 0.5);
  return way;
}

TEST(TimedWay, IsWhereItsSpeedBringsItAndStaysAtItsEnd) {
  EXPECT_EQ(round_a_corner().length_m(), 5);
  EXPECT_EQ(round_a_corner().end_s(), 10);
  EXPECT_EQ(round_a_corner().at_s(2), Eigen::Vector2d(1, 0));
  EXPECT_EQ(round_a_corner().at_s(6), Eigen::Vector2d(2, 1));
  EXPECT_EQ(round_a_corner().at_s(60), Eigen::Vector2d(2, 3));
}

TEST(TimedWay, HeadsWhereItDrivesAndNowhereWhereItStands) {
  EXPECT_EQ(round_a_corner().heading_at_s(2), Eigen::Vector2d(1, 0));
  EXPECT_EQ(round_a_corner().heading_at_s(6), Eigen::Vector2d(0, 1));
  EXPECT_EQ(round_a_corner().heading_at_s(11), Eigen::Vector2d::Zero());
}

TEST(TimedWay, ComesNearAPointOnlyInTheTimeThatIsAsked) {
  const Eigen::Vector2d corner(2, 0);
  EXPECT_EQ(round_a_corner().nearest_m(corner, 0, 20), 0);
  EXPECT_EQ(round_a_corner().nearest_m(corner, -5, 2), 1);
  EXPECT_EQ(round_a_corner().nearest_m(corner, 8, 50), 2);
}

TEST(TimedWay, OfOnePointItStandsThere) {
  const TimedWay way({{1, 1}}, 0.5);
  EXPECT_EQ(way.at_s(3), Eigen::Vector2d(1, 1));
  EXPECT_EQ(way.nearest_m({1, 2}, 0, 9), 1);
}

}  // namespace
}  // namespace isthmus
