#include "server/engine/map/map.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

PatchPtr bare_patch(int id) {
  auto patch = std::make_shared<Patch>();
  patch->id = PatchId{id};
  return patch;
}

Relation step(int a, int b, const Pose& a_from_b = {1, 0, 0}) {
  return small_maps::relation(a, b, RelativePose{a_from_b, 100 * Eigen::Matrix3d::Identity()});
}

// Two islands of three patches a metre apart:
//
//      0 --- 1 --- 2        3 --- 4 --- 5
Map two_islands() {
  Map map;
  for (int i = 0; i < 6; ++i) map.add(bare_patch(i), {1.0 * (i % 3), 0, 0});
  for (const int i : {0, 1, 3, 4}) map.relate(step(i, i + 1));
  return map;
}

const Pose& pose(const Map& map, int id) { return map.manifold().pose(PatchId{id}); }

TEST(Map, RemovingWhatJoinedTwoIslandsPartsThemAndLeavesThePoses) {
  Map map = two_islands();
  const RelationId link[] = {map.relate(step(2, 3, {5, 0, 0})), map.relate(step(0, 5, {9, 0, 0}))};
  EXPECT_EQ(map.graph().islands().size(), 1U);
  const std::vector<Pose> before(map.manifold().poses().begin(), map.manifold().poses().end());
  map.remove({link, 1});
  EXPECT_EQ(map.graph().islands().size(), 1U);
  map.remove({link + 1, 1});
  EXPECT_EQ(map.graph().islands().size(), 2U);
  EXPECT_EQ(map.graph().island(PatchId{5}), PatchId{3});
  for (int i = 0; i < 6; ++i) EXPECT_EQ(pose(map, i), before[static_cast<std::size_t>(i)]);
}

TEST(Map, RemovingStampsThePatchesItTouchedAndNoOthers) {
  Map map = two_islands();
  const RelationId link = map.relate(step(2, 3));
  const PatchId touched[] = {PatchId{2}}, also[] = {PatchId{3}}, others[] = {PatchId{0}, PatchId{1}};
  const std::int64_t stamps[] = {map.stamp(touched), map.stamp(also), map.stamp(others)};
  map.remove({&link, 1});
  EXPECT_GT(map.stamp(touched), stamps[0]);
  EXPECT_GT(map.stamp(also), stamps[1]);
  EXPECT_EQ(map.stamp(others), stamps[2]);
  map.remove({&link, 1});  // once more: nothing is left to take away
  EXPECT_EQ(map.stamp(others), stamps[2]);
}

TEST(Map, AnIslandMovesAsOneRigidThingAndTheOthersStay) {
  Map map = two_islands();
  const Pose new_from_old{10, -2, 0.5};
  const Pose fourth_from_fifth = ominus(pose(map, 4), pose(map, 3));
  const PatchId others[] = {PatchId{0}, PatchId{1}, PatchId{2}};
  const std::int64_t stamp = map.stamp(others);
  map.move_island(PatchId{3}, new_from_old);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(pose(map, i), (Pose{1.0 * i, 0, 0}));
  for (int i = 3; i < 6; ++i) EXPECT_EQ(pose(map, i), (new_from_old * Pose{1.0 * (i % 3), 0, 0}));
  const Pose after = ominus(pose(map, 4), pose(map, 3));
  EXPECT_NEAR((to_vector(after) - to_vector(fourth_from_fifth)).norm(), 0, 1e-12);
  EXPECT_EQ(map.stamp(others), stamp);
}

// A fit of a copy knew patches 0 to 5; 6 and 7 have been made since, one after the other.
TEST(Map, AdoptingAFitCarriesAlongWhatWasMadeSince) {
  Map map = two_islands();
  std::vector<Pose> fitted(map.manifold().poses().begin(), map.manifold().poses().end());
  for (int i = 0; i < 3; ++i) fitted[static_cast<std::size_t>(i)] = {1.1 * i, 0.2 * i, 0.1 * i};
  map.add(bare_patch(6), {3, 0, 0});
  map.relate(step(2, 6));
  map.add(bare_patch(7), {3, 1, 0.3});
  map.relate(step(6, 7));
  const PatchId island[] = {PatchId{0}, PatchId{1}, PatchId{2}};
  map.adopt(island, fitted);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(pose(map, i), fitted[static_cast<std::size_t>(i)]);
  for (int i = 3; i < 6; ++i) EXPECT_EQ(pose(map, i), (Pose{1.0 * (i % 3), 0, 0}));
  const Pose second_from_sixth = ominus(pose(map, 6), pose(map, 2));
  EXPECT_NEAR((to_vector(second_from_sixth) - Eigen::Vector3d(1, 0, 0)).norm(), 0, 1e-12);
  const Pose sixth_from_seventh = ominus(pose(map, 7), pose(map, 6));
  EXPECT_NEAR((to_vector(sixth_from_seventh) - Eigen::Vector3d(0, 1, 0.3)).norm(), 0, 1e-12);
}

TEST(Map, AdoptingLeavesWhatWasMadeSinceOnAnotherIslandWhereItIs) {
  Map map = two_islands();
  std::vector<Pose> fitted(map.manifold().poses().begin(), map.manifold().poses().end());
  fitted[1] = {1.5, 0, 0};
  map.add(bare_patch(6), {3, 0, 0});
  map.relate(step(5, 6));
  const PatchId island[] = {PatchId{0}, PatchId{1}, PatchId{2}};
  map.adopt(island, fitted);
  EXPECT_EQ(pose(map, 6), (Pose{3, 0, 0}));
  EXPECT_EQ(pose(map, 1), (Pose{1.5, 0, 0}));
}

TEST(Map, RefittingHoldsTheOldestPatchOfTheIsland) {
  Map map = two_islands();
  const PatchId all[] = {PatchId{0}, PatchId{1}, PatchId{2}};
  map.adopt(all, std::vector<Pose>{{0.5, 0.5, 0}, {1, 0, 0}, {9, 9, 0}, {}, {}, {}});
  map.refit_around(PatchId{1}, 10);
  EXPECT_EQ(pose(map, 0), (Pose{0.5, 0.5, 0}));
  EXPECT_NEAR(pose(map, 1).x, 1.5, 1e-6);
  EXPECT_NEAR(pose(map, 2).x, 2.5, 1e-6);
  EXPECT_NEAR(pose(map, 2).y, 0.5, 1e-6);
}

}  // namespace
}  // namespace isthmus
