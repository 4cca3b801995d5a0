#include "server/paths/ground/ground_keeper.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

TEST(GroundKeeper, AGroundStaysWhileNothingOnItChanges) {
  Map map;
  testing::add_round_way(map, testing::furnished_room(), {{-1, 0, 0}, {1, 0, 0}});
  GroundKeeper keeper;
  keeper.update(testing::copy_of(map));
  const auto before = keeper.ground(IslandId{0});
  MapCopy nudged = testing::copy_of(map);
  nudged.poses[1].x += 0.01;  // less than half a cell
  keeper.update(nudged);
  EXPECT_EQ(keeper.ground(IslandId{0}), before);
  nudged.poses[1].x += 0.05;
  keeper.update(nudged);
  EXPECT_NE(keeper.ground(IslandId{0}), before);
}

TEST(GroundKeeper, AnotherIslandsGroundStaysWhenOneGrows) {
  Map map;
  testing::add_round_way(map, testing::furnished_room(), {{-1, 0, 0}, {1, 0, 0}});
  map.add(testing::round_patch(testing::furnished_room(), PatchId{2}, {}), {});
  GroundKeeper keeper;
  keeper.update(testing::copy_of(map));
  const auto first = keeper.ground(IslandId{0}), second = keeper.ground(IslandId{2});
  map.add(testing::round_patch(testing::furnished_room(), PatchId{3}, {1, 0, 0}), {1, 0, 0});
  map.relate(testing::odometry_relation(PatchId{2}, PatchId{3}, {1, 0, 0}));
  keeper.update(testing::copy_of(map));
  EXPECT_EQ(keeper.ground(IslandId{0}), first);
  EXPECT_NE(keeper.ground(IslandId{2}), second);
}

TEST(GroundKeeper, ARelationMakesLayersOneThoughNoPatchMoves) {
  testing::Spiral spiral;
  GroundKeeper keeper;
  const auto layers = [&] {
    keeper.update(testing::copy_of(spiral.map));
    const auto [first, last] =
        keeper.ground(IslandId{0})->at(cell_of(position(spiral.map.manifold().pose(PatchId{20}))));
    return last - first;
  };
  EXPECT_EQ(layers(), 2);
  spiral.close(20);
  EXPECT_EQ(layers(), 1);
}

// A sighting places the second robot's patch .15 rad askew: its walls cross what the first has seen to be
// free.
TEST(GroundKeeper, WallsOfAnotherRobotBarNothingThatOneHasSeenUntilScansJoinTheirMaps) {
  Map map;
  map.add(testing::round_patch(testing::furnished_room(), PatchId{0}, {}), {});
  map.add(testing::round_patch(testing::furnished_room(), PatchId{1}, {1, 0, 0}), {1, 0, 0.15});
  Relation relation = testing::odometry_relation(PatchId{0}, PatchId{1}, {1, 0, 0.15});
  relation.kind = RelationKind::relative_pose;
  map.relate(relation);
  GroundKeeper keeper;
  const auto barred = [&] {
    keeper.update(testing::copy_of(map));
    const auto ground = keeper.ground(IslandId{0});
    int cells = 0;
    for (double x = -3.8; x < -3.6; x += ground_cell_m)
      for (double y = -2.7; y < -1.8; y += ground_cell_m)
        for (auto [node, last] = ground->at(cell_of({x, y})); node != last; ++node)
          cells += ground->layer(node).occupied ? 1 : 0;
    return cells;
  };
  EXPECT_EQ(barred(), 0);
  relation.kind = RelationKind::point_to_line;
  map.relate(relation);
  EXPECT_GT(barred(), 5) << "now they are of one part, and contradict one another";
}

/// Of where a robot began and came back to, after so many metres out and as many back.
NodeId layers_after(int metres) {
  Map map;
  for (int i = 0; i <= 2 * metres; ++i) {
    const PatchId id{i};
    map.add(testing::round_patch(testing::corridor(), id, {}, 2.5),
            {1.0 * std::min(i, 2 * metres - i), 0, 0});
    if (i > 0) map.relate(testing::odometry_relation(PatchId{i - 1}, id, {i <= metres ? 1.0 : -1.0, 0, 0}));
  }
  GroundKeeper keeper;
  keeper.update(testing::copy_of(map));
  const auto [first, last] = keeper.ground(IslandId{0})->at(cell_of({0, 0}));
  return last - first;
}

TEST(GroundKeeper, WithinSixtyMetresAlongRelationsAPlaceIsOneAndBeyondItMayHaveDrifted) {
  EXPECT_EQ(layers_after(29), 1);
  EXPECT_EQ(layers_after(33), 2);
}

TEST(GroundKeeper, AnIslandThatIsGoneHasNoGround) {
  Map map;
  map.add(testing::round_patch(testing::furnished_room(), PatchId{0}, {}), {});
  map.add(testing::round_patch(testing::furnished_room(), PatchId{1}, {}), {});
  GroundKeeper keeper;
  keeper.update(testing::copy_of(map));
  EXPECT_NE(keeper.ground(IslandId{1}), nullptr);
  map.relate(testing::odometry_relation(PatchId{0}, PatchId{1}, {}));
  keeper.update(testing::copy_of(map));
  EXPECT_EQ(keeper.ground(IslandId{1}), nullptr);
  EXPECT_NE(keeper.ground(IslandId{0}), nullptr);
}

TEST(GroundKeeper, WhereARobotDroveIsGroundThatNoBeamHasToHaveSeen) {
  Map map;
  map.add(testing::round_patch(testing::corridor(), PatchId{0}, {}, 3), {});
  MapCopy copy = testing::copy_of(map);
  GroundKeeper keeper;
  const Cell ahead = cell_of({5, 0});
  keeper.update(copy);
  EXPECT_EQ(keeper.ground(IslandId{0})->find(ahead, PatchId{0}), -1);
  const auto rows = std::make_shared<TrajectoryStore>();
  for (int i = 0; i < 60; ++i) rows->append({i, 0, PatchId{0}, {0.1 * i, 0, 0}});
  ASSERT_TRUE(rows->flush());
  copy.trajectory = rows;
  copy.trajectory_rows = rows->size();
  keeper.update(copy);
  const NodeId node = keeper.ground(IslandId{0})->find(ahead, PatchId{0});
  ASSERT_GE(node, 0);
  EXPECT_FALSE(keeper.ground(IslandId{0})->layer(node).occupied);
}

}  // namespace
}  // namespace isthmus
