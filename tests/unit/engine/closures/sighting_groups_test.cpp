#include "server/engine/closures/sighting_groups.hpp"

#include <gtest/gtest.h>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

/// R1 has seen R2 at some seconds.
std::vector<Evidence> pool_of(const SideBySide& scene, const std::vector<double>& seconds) {
  std::vector<Evidence> pool;
  for (const double s : seconds) pool.push_back(scene.evidence(SideBySide::r1_sees_r2(s), pool.size()));
  return pool;
}

TEST(SightingGroups, BetweenTwoIslandsAreOneForAllTime) {
  SideBySide scene;
  std::vector<Evidence> pool = pool_of(scene, {10, 500});
  pool.push_back(scene.evidence(SideBySide::r2_sees_r1(12), 2));
  const std::vector<SightingGroup> groups = groups_of(scene.map, pool, {});
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_TRUE(groups[0].is_merge());
  EXPECT_EQ(std::get<IslandPair>(groups[0].key), (IslandPair{PatchId{0}, PatchId{6}}));
  EXPECT_EQ(groups[0].members, (std::vector<std::size_t>{0, 1, 2}));
}

TEST(SightingGroups, OnOneIslandAreThoseOfAnEncounterOfTwo) {
  SideBySide scene;
  scene.join();
  std::vector<Evidence> pool = pool_of(scene, {10, 60, 130});
  pool.push_back(scene.evidence(SideBySide::r2_sees_r1(140), 3));
  const std::vector<SightingGroup> groups = groups_of(scene.map, pool, {});
  ASSERT_EQ(groups.size(), 2U) << "more than a minute between the second and the third";
  EXPECT_FALSE(groups[0].is_merge());
  EXPECT_EQ(groups[0].members, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(groups[1].members, (std::vector<std::size_t>{2, 3})) << "whoever saw whom";
  EXPECT_EQ(std::get<Encounter>(groups[1].key), (Encounter{"R1", "R2", 2}));
}

TEST(SightingGroups, OfWhatIsNowhereThereAreNone) {
  SideBySide scene;
  std::vector<Evidence> pool = pool_of(scene, {10, 11});
  for (Evidence& evidence : pool) evidence.target_place.reset();
  EXPECT_TRUE(groups_of(scene.map, pool, {}).empty());
}

TEST(SightingGroups, AreLookedAtByTimeAndByAge) {
  const Encounter ninth{"R1", "R2", 9}, tenth{"R1", "R2", 10};
  const IslandPair second{PatchId{0}, PatchId{9}}, third{PatchId{0}, PatchId{10}};
  EXPECT_LT(GroupKey(ninth), GroupKey(tenth));
  EXPECT_LT(GroupKey(tenth), GroupKey(second)) << "loops before merges";
  EXPECT_LT(GroupKey(second), GroupKey(third));
}

TEST(SightingGroups, OfSmallIslandsAreTriedFirstAndLoopsBefore) {
  SideBySide scene;  // of six patches each
  const PatchId lone = scene.map.manifold().next_id();
  scene.map.add(make_tag_patch(lone, 50, 0), {});
  const PatchId first = scene.first[0], second = scene.second[0];
  const std::vector<SightingGroup> groups =
      smallest_merges_first(scene.map, {{IslandPair{first, second}, first, second, {0}},
                                        {IslandPair{first, lone}, first, lone, {1}},
                                        {IslandPair{second, lone}, second, lone, {2}},
                                        {Encounter{"R1", "R2", 3}, first, first, {3}}});
  std::vector<std::size_t> order;
  for (const SightingGroup& group : groups) order.push_back(group.members.front());
  EXPECT_EQ(order, (std::vector<std::size_t>{3, 1, 2, 0})) << "of equal ones that which was first";
}

TEST(Superfluous, AreLoopsThatHaveWaitedForTwoMinutes) {
  SideBySide scene;
  const std::vector<Evidence> pool = pool_of(scene, {10, 20});
  const std::int64_t now = SideBySide::utime(131);
  EXPECT_TRUE(superfluous(pool, groups_of(scene.map, pool, {}), now, {}).empty()) << "merges wait for ever";
  scene.join();
  EXPECT_EQ(superfluous(pool, groups_of(scene.map, pool, {}), now, {}), std::set<std::size_t>{0});
}

TEST(Superfluous, AreTheOldestOfMoreThanFourHundred) {
  SideBySide scene;
  std::vector<Evidence> pool = pool_of(scene, std::vector<double>(402, 10));
  EXPECT_EQ(superfluous(pool, groups_of(scene.map, pool, {}), 0, {}), (std::set<std::size_t>{0, 1}));
  for (Evidence& evidence : pool) evidence.target_place.reset();
  EXPECT_EQ(superfluous(pool, {}, 0, {}), (std::set<std::size_t>{0, 1})) << "of a tag that is nowhere too";
}

}  // namespace
}  // namespace isthmus
