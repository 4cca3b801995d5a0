#include "server/engine/map/ways.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

// Patches at given places, related in the order given.
Map map_of(const std::vector<Pose>& poses, const std::vector<std::pair<int, int>>& related) {
  Map map;
  for (const Pose& pose : poses) {
    auto patch = std::make_shared<Patch>();
    patch->id = map.manifold().next_id();
    map.add(patch, pose);
  }
  for (const auto& [a, b] : related) {
    const Pose a_from_b = map.relative_pose(PatchId{a}, PatchId{b});
    map.relate(small_maps::relation(a, b, RelativePose{a_from_b, Eigen::Matrix3d::Identity()}));
  }
  return map;
}

std::vector<double> ways_from(const Map& map, const std::vector<PatchId>& from) {
  std::vector<double> ways = ways_over_relations_m(map, from);
  EXPECT_EQ(WayNetwork(map).ways_m(from), ways);
  return ways;
}

//  0 - 1 - 2 - 3     4 (on another island)
//   \_________/
TEST(WaysOverRelations, GoTheShortestWayHoweverManyRelationsItHas) {
  const Map map =
      map_of({{0, 0, 0}, {3, 4, 0}, {6, 0, 0}, {6, 1, 0}, {0, 1, 0}}, {{0, 1}, {1, 2}, {2, 3}, {0, 2}});
  EXPECT_EQ(ways_from(map, {PatchId{0}}), (std::vector<double>{0, 5, 6, 7, HUGE_VAL}));
  EXPECT_EQ(ways_from(map, {PatchId{3}}), (std::vector<double>{7, 6, 1, 0, HUGE_VAL}));
  const Map detour = map_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 30, 0}}, {{0, 3}, {3, 2}, {0, 1}, {1, 2}});
  EXPECT_EQ(ways_from(detour, {PatchId{0}})[2], 2) << "not over the patch that is 30 m off";
}

//  1 - 0 ----- 2 - 3, and 1 - 3: that way is found first.
TEST(WaysOverRelations, AreNotTheFirstThatIsFound) {
  const Map map = map_of({{0, 0, 0}, {-1, 0, 0}, {5, 0, 0}, {6, 0, 0}}, {{0, 1}, {1, 3}, {0, 2}, {2, 3}});
  EXPECT_EQ(ways_from(map, {PatchId{0}})[3], 6);
}

TEST(WaysOverRelations, AreFromTheNearestOfSeveral) {
  const Map map =
      map_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {9, 0, 0}}, {{0, 1}, {1, 2}, {2, 3}, {3, 4}});
  EXPECT_EQ(ways_from(map, {PatchId{0}, PatchId{3}}), (std::vector<double>{0, 1, 1, 0, 6}));
  EXPECT_EQ(ways_from(map, {}), std::vector<double>(5, HUGE_VAL));
}

}  // namespace
}  // namespace isthmus
