#include "server/paths/questions/frontiers.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::node_at;
using testing::Seen;

constexpr Footprint narrow_footprint{0.1, 0.05};

/// A room of 5 m with walls all round, but for a doorway of so many cells in the wall at x = 5 m.
std::shared_ptr<const Ground> room_with_door(int door_cells) {
  return testing::ground_of(100, [door_cells](int x, int y) {
    const bool edge = x == 0 || y == 0 || x == 99 || y == 99;
    const bool door = x == 99 && y >= 40 && y < 40 + door_cells;
    return edge && !door ? Seen::occupied : Seen::open;
  });
}

TEST(Frontiers, ADoorwayToTheUnseenIsOne) {
  const Roadmap roadmap(room_with_door(20), narrow_footprint);
  const auto found = find_frontiers(roadmap, node_at(roadmap.ground(), 20, 50));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].size_m, 20 * ground_cell_m, 0.1);
  EXPECT_NEAR((found[0].middle - Eigen::Vector2d(4.975, 2.5)).norm(), 0, 0.05);
  ASSERT_GE(found[0].viewpoint, 0);
  EXPECT_TRUE(roadmap.fits(found[0].viewpoint));
  EXPECT_NEAR(found[0].cost_m, 4, 0.4);
}

TEST(Frontiers, TheGainIsWhatWouldBeSeenThroughIt) {
  const Roadmap narrow(room_with_door(16), narrow_footprint), wide(room_with_door(40), narrow_footprint);
  const NodeId from = node_at(narrow.ground(), 20, 50);
  const auto small = find_frontiers(narrow, from), large = find_frontiers(wide, from);
  ASSERT_EQ(small.size(), 1U);
  ASSERT_EQ(large.size(), 1U);
  EXPECT_GT(small[0].gain_m2, 1);
  EXPECT_GT(large[0].gain_m2, 1.3 * small[0].gain_m2);
  EXPECT_LT(large[0].gain_m2, 0.5 * 3.15 * 16 + 1);  // half a disc of 4 m
}

TEST(Frontiers, AClosedRoomAndAGapBetweenBeamsHaveNone) {
  for (const int door_cells : {0, 3}) {
    const Roadmap roadmap(room_with_door(door_cells), narrow_footprint);
    EXPECT_TRUE(find_frontiers(roadmap, node_at(roadmap.ground(), 20, 50)).empty()) << door_cells;
  }
}

TEST(Frontiers, OneThatIsNarrowerThanTheRobotIsNone) {
  const auto ground = room_with_door(9);  // .45 m
  const Roadmap slim_road(ground, narrow_footprint), wide_road(ground, {0.25, 0});
  EXPECT_EQ(find_frontiers(slim_road, -1).size(), 1U);
  EXPECT_TRUE(find_frontiers(wide_road, -1).empty());
}

TEST(Frontiers, AVeryLongOneIsCutInPiecesThatLieSideBySide) {
  const auto ground = testing::ground_of(120, [](int x, int y) {
    return x == 0 || y == 0 || y == 119 ? Seen::occupied : Seen::open;  // 6 m long, at x = 6 m
  });
  const Roadmap roadmap(ground, narrow_footprint);
  FrontierOptions options;
  options.max_size_m = 2;
  const auto found = find_frontiers(roadmap, -1, options);
  ASSERT_EQ(found.size(), 4U);
  for (const Frontier& one : found) {
    EXPECT_LE(one.size_m, 2);
    EXPECT_GE(one.size_m, 1.3);
    EXPECT_NEAR(one.middle.x(), 5.975, 1e-6);
    for (const Frontier& other : found) {
      if (&one == &other) continue;
      EXPECT_GE((one.middle - other.middle).norm(), 1.3);
    }
  }
  options.max_size_m = 8;
  EXPECT_EQ(find_frontiers(roadmap, -1, options).size(), 1U);
}

TEST(Frontiers, AViewpointCloseUpDoesNotDependOnWhereTheRobotIs) {
  const Roadmap roadmap(room_with_door(20), narrow_footprint);
  const auto from = [&](int x, int y) { return node_at(roadmap.ground(), x, y); };
  FrontierOptions options;
  options.close_up = true;
  const auto one = find_frontiers(roadmap, from(20, 50), options),
             other = find_frontiers(roadmap, from(60, 20), options);
  ASSERT_EQ(one.size(), 1U);
  ASSERT_EQ(other.size(), 1U);
  const auto away_m = [&](const Frontier& frontier) {
    return (roadmap.ground().centre(frontier.viewpoint) - frontier.middle).norm();
  };
  EXPECT_LE(away_m(one[0]), 0.6);
  EXPECT_LE(away_m(other[0]), 0.6);
}

TEST(Frontiers, OneThatCannotBeReachedCostsInfinitely) {
  const auto ground = testing::ground_of(100, [](int x, int y) {
    const bool edge = x == 0 || y == 0 || y == 99;
    return edge || x == 50 ? Seen::occupied : Seen::open;
  });
  const Roadmap roadmap(ground, narrow_footprint);
  const auto found = find_frontiers(roadmap, node_at(*ground, 20, 50));
  ASSERT_FALSE(found.empty());
  for (const Frontier& one : found) EXPECT_EQ(one.cost_m, std::numeric_limits<double>::infinity());
}

TEST(Frontiers, WithoutARobotCostsAreTheWayFromTheViewpoint) {
  const Roadmap roadmap(room_with_door(20), narrow_footprint);
  const auto found = find_frontiers(roadmap, -1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_LE(found[0].cost_m, 0.5);
}

}  // namespace
}  // namespace isthmus
