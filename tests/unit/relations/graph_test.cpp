#include "relations/graph.hpp"

#include <gtest/gtest.h>

#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

using namespace small_maps;

RelationGraph patches(int count) {
  RelationGraph graph;
  for (int i = 0; i < count; ++i) graph.add_patch(PatchId{i});
  return graph;
}

RelationId join(RelationGraph& graph, int a, int b) { return graph.add(relation(a, b, RelativePose{})); }

std::vector<int> values(const std::vector<PatchId>& ids) {
  std::vector<int> found;
  for (const PatchId id : ids) found.push_back(id.value);
  return found;
}

TEST(RelationGraph, EveryPatchStartsAsAnIslandOfItsOwn) {
  const RelationGraph graph = patches(3);
  EXPECT_EQ(graph.islands().size(), 3U);
  EXPECT_EQ(graph.island(PatchId{2}), PatchId{2});
}

TEST(RelationGraph, RelationsJoinIslandsUnderTheLowestId) {
  RelationGraph graph = patches(6);
  join(graph, 5, 4);
  join(graph, 3, 5);
  join(graph, 2, 0);
  EXPECT_EQ(graph.island(PatchId{4}), PatchId{3});
  EXPECT_EQ(graph.island(PatchId{2}), PatchId{0});
  join(graph, 4, 2);
  EXPECT_EQ(graph.island(PatchId{5}), PatchId{0});
  EXPECT_EQ(values(graph.patches_of(PatchId{0})), (std::vector<int>{0, 2, 3, 4, 5}));
  EXPECT_EQ(values(graph.islands()[1]), std::vector<int>{1});
}

//   0 - 1 - 2 ~ 3 - 4     ~ is withdrawn
TEST(RelationGraph, WithdrawalPartsAnIslandWhereNothingElseJoinsIt) {
  RelationGraph graph = patches(5);
  join(graph, 0, 1);
  join(graph, 1, 2);
  const RelationId closure = join(graph, 2, 3);
  join(graph, 3, 4);
  graph.remove(closure);
  EXPECT_EQ(graph.island(PatchId{4}), PatchId{3});
  EXPECT_EQ(graph.island(PatchId{2}), PatchId{0});
  EXPECT_EQ(graph.find(closure), nullptr);
  EXPECT_EQ(graph.relations().size(), 3U);
}

//   0 - 1 - 2 - 3 - 4 - 5 - 0   a ring
TEST(RelationGraph, RingStaysOneIslandAfterOneWithdrawalAndPartsAfterTwo) {
  RelationGraph graph = patches(6);
  std::vector<RelationId> ring;
  for (int i = 0; i < 6; ++i) ring.push_back(join(graph, i, (i + 1) % 6));
  graph.remove(ring[0]);
  EXPECT_EQ(graph.islands().size(), 1U);
  graph.remove(ring[3]);
  ASSERT_EQ(graph.islands().size(), 2U);
  EXPECT_EQ(values(graph.islands()[0]), (std::vector<int>{0, 4, 5}));
}

TEST(RelationGraph, WithdrawalOfManyAtOnceIsThatOfEach) {
  std::mt19937 random(1);
  SmallMap map = random_map(random, 30, 60, 0);
  RelationGraph one_by_one = map.graph;
  std::vector<RelationId> gone;
  for (const auto& [id, relation] : map.graph.relations())
    if (id.value % 3 != 0) gone.push_back(id);
  for (const RelationId id : gone) one_by_one.remove(id);
  map.graph.remove(gone);
  EXPECT_EQ(map.graph.islands(), one_by_one.islands());
  EXPECT_GT(map.graph.islands().size(), 1U);
}

TEST(RelationGraph, IdsAreNeverUsedAgain) {
  RelationGraph graph = patches(2);
  const RelationId first = join(graph, 0, 1);
  graph.remove(first);
  EXPECT_GT(join(graph, 0, 1), first);
}

TEST(RelationGraph, CopyIsAVersionOfItsOwn) {
  RelationGraph graph = patches(2);
  const RelationId id = join(graph, 0, 1);
  const RelationGraph copy = graph;
  graph.remove(id);
  EXPECT_NE(copy.find(id), nullptr);
  EXPECT_EQ(copy.island(PatchId{1}), PatchId{0});
  EXPECT_EQ(graph.island(PatchId{1}), PatchId{1});
}

TEST(RelationGraph, RefusesWhatIsNoRelation) {
  RelationGraph graph = patches(2);
  EXPECT_THROW(join(graph, 0, 0), std::invalid_argument);
  EXPECT_THROW(join(graph, 0, 7), std::invalid_argument);
  EXPECT_THROW(graph.add_patch(PatchId{5}), std::invalid_argument);
  EXPECT_EQ(graph.relations().size(), 0U);
}

TEST(RelationGraph, NeighboursAndBetweenSeeBothDirections) {
  RelationGraph graph = patches(4);
  const RelationId there = join(graph, 2, 1);
  const RelationId back = join(graph, 1, 2);
  join(graph, 1, 0);
  EXPECT_EQ(values(graph.neighbours(PatchId{1})), (std::vector<int>{0, 2}));
  EXPECT_EQ(graph.between(PatchId{1}, PatchId{2}), (std::vector<RelationId>{there, back}));
  EXPECT_TRUE(graph.neighbours(PatchId{3}).empty());
}

//       3
//       |
//   0 - 1 - 2 - 4 - 5
TEST(RelationGraph, NearestInGraphGoesByHopsThenById) {
  RelationGraph graph = patches(6);
  join(graph, 5, 4);
  join(graph, 4, 2);
  join(graph, 1, 3);
  join(graph, 1, 2);
  join(graph, 0, 1);
  EXPECT_EQ(values(graph.nearest_in_graph(PatchId{1}, 5)), (std::vector<int>{1, 0, 2, 3, 4}));
  EXPECT_EQ(values(graph.nearest_in_graph(PatchId{1}, 3)), (std::vector<int>{1, 0, 2}));
  EXPECT_EQ(graph.hops(PatchId{0}, PatchId{5}, 10), 4);
  EXPECT_EQ(graph.hops(PatchId{0}, PatchId{5}, 3), std::nullopt);
  EXPECT_EQ(graph.hops(PatchId{0}, PatchId{0}, 0), 0);
}

//   0 === 1 --- 2 === 3 === 4      6
//               |     |
//               5 === +            === match, --- odometry
TEST(RelationGraph, WithinHopsGoesAlongTheRelationsThatCountOnly) {
  RelationGraph graph = patches(7);
  const auto join_by = [&](int a, int b, OriginKind kind) {
    Relation made = relation(a, b, RelativePose{});
    made.origin.kind = kind;
    return graph.add(made);
  };
  join_by(1, 0, OriginKind::match);
  join_by(1, 2, OriginKind::odometry);
  join_by(2, 3, OriginKind::match);
  join_by(4, 3, OriginKind::match);
  join_by(2, 5, OriginKind::odometry);
  join_by(5, 3, OriginKind::match);
  const auto any = [](const Relation&) { return true; };
  const auto matches = [](const Relation& r) { return r.origin.kind == OriginKind::match; };
  EXPECT_EQ(values(graph.within_hops(PatchId{2}, 0, any)), (std::vector<int>{2}));
  EXPECT_EQ(values(graph.within_hops(PatchId{2}, 1, any)), (std::vector<int>{1, 2, 3, 5}));
  EXPECT_EQ(values(graph.within_hops(PatchId{2}, 2, any)), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(values(graph.within_hops(PatchId{2}, 1, matches)), (std::vector<int>{2, 3}));
  EXPECT_EQ(values(graph.within_hops(PatchId{2}, 9, matches)), (std::vector<int>{2, 3, 4, 5}));
  EXPECT_EQ(values(graph.within_hops(PatchId{1}, 9, matches)), (std::vector<int>{0, 1}));
  EXPECT_EQ(values(graph.within_hops(PatchId{6}, 9, any)), (std::vector<int>{6}));
}

}  // namespace
}  // namespace isthmus
