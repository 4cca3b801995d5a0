// Two robots' chains of patches, and what joins them:
//
//   R1   0 --- 1 --- 2 --- 3 ... 8       odometry
//              :     |
//   R2         9 --- 10 --- 11 ... 17    : closure, | a later match

#include "server/engine/map/dependencies.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

constexpr int per_robot = 9;

Relation relation(int a, int b, Origin origin) {
  Relation relation;
  relation.a = PatchId{a};
  relation.b = PatchId{b};
  relation.origin = origin;
  const bool by_scans = origin.kind == OriginKind::match || origin.kind == OriginKind::propagation ||
                        origin.kind == OriginKind::hypothesis;
  relation.kind = origin.kind == OriginKind::odometry ? RelationKind::odometry
                  : by_scans                          ? RelationKind::point_to_line
                                                      : RelationKind::range;
  relation.measurement = RelativePose{};
  return relation;
}

constexpr Origin by_odometry{OriginKind::odometry, {}};
constexpr Origin by_match{OriginKind::match, {}};
constexpr Origin by_sighting{OriginKind::sighting, {}};

Origin sighting_of(int closure) { return {OriginKind::sighting, ClosureId{closure}}; }
Origin propagation_of(int closure) { return {OriginKind::propagation, ClosureId{closure}}; }

RelationGraph two_chains() {
  RelationGraph graph;
  for (int i = 0; i < 2 * per_robot; ++i) graph.add_patch(PatchId{i});
  for (int i = 0; i < 2 * per_robot; ++i)
    if (i % per_robot > 0) graph.add(relation(i - 1, i, by_odometry));
  return graph;
}

std::vector<int> of(const RelationGraph& graph, RelationId id) {
  const Dependencies dependencies(graph);
  std::vector<int> closures;
  for (const ClosureId closure : dependencies.of(id)) closures.push_back(closure.value);
  return closures;
}

TEST(Dependencies, WhatRobotsDoOnTheirOwnDependsOnNothing) {
  RelationGraph graph = two_chains();
  const RelationId before = graph.add(relation(3, 1, by_match));
  graph.add(relation(1, 9, sighting_of(4)));
  const RelationId after = graph.add(relation(4, 2, by_match));
  const RelationId along = graph.add(relation(8, 0, {OriginKind::start, {}}));
  for (const RelationId id : {before, after, along, RelationId{0}})
    EXPECT_EQ(of(graph, id), std::vector<int>{});
}

TEST(Dependencies, WhatAClosureMakesShorterIsKnownWithoutItAllTheSame) {
  RelationGraph graph = two_chains();
  graph.add(relation(0, 9, propagation_of(4)));
  graph.add(relation(4, 10, propagation_of(4)));
  EXPECT_EQ(of(graph, graph.add(relation(4, 0, by_match))), std::vector<int>{})
      << "by four steps of odometry";
  EXPECT_EQ(of(graph, graph.add(relation(5, 0, by_match))), std::vector<int>{}) << "and by that match";
}

TEST(Dependencies, AClosuresOwnDependOnIt) {
  RelationGraph graph = two_chains();
  const RelationId seen = graph.add(relation(1, 9, sighting_of(4)));
  const RelationId passed_on = graph.add(relation(2, 10, propagation_of(4)));
  EXPECT_EQ(of(graph, seen), std::vector<int>{4});
  EXPECT_EQ(of(graph, passed_on), std::vector<int>{4});
}

TEST(Dependencies, AMatchOrSightingAcrossTheBorderDependsOnWhatJoinedTheTwo) {
  RelationGraph graph = two_chains();
  graph.add(relation(1, 9, sighting_of(4)));
  const RelationId matched = graph.add(relation(2, 10, by_match));
  const RelationId seen = graph.add(relation(5, 13, by_sighting));
  EXPECT_EQ(of(graph, matched), std::vector<int>{4});
  EXPECT_EQ(of(graph, seen), std::vector<int>{4});
  EXPECT_TRUE(Dependencies(graph).has(seen, ClosureId{4}));
  EXPECT_FALSE(Dependencies(graph).has(seen, ClosureId{3}));
}

TEST(Dependencies, ALaterClosureOnWhatAnotherJoinedDependsOnBoth) {
  RelationGraph graph = two_chains();
  graph.add(relation(1, 9, sighting_of(4)));
  const RelationId later = graph.add(relation(8, 17, sighting_of(6)));
  EXPECT_EQ(of(graph, later), (std::vector<int>{4, 6}));
}

TEST(Dependencies, OfAMatchOverALoopThatAClosureClosedAreOnThatClosure) {
  RelationGraph graph = two_chains();
  graph.add(relation(0, 8, sighting_of(2)));
  const RelationId over = graph.add(relation(1, 8, by_match));
  EXPECT_EQ(of(graph, over), std::vector<int>{2});
}

TEST(ClosuresBetween, AreThoseOfTheWayThatAMapKnowsItBy) {
  RelationGraph graph = two_chains();
  EXPECT_TRUE(closures_between(graph, PatchId{0}, PatchId{12}).empty()) << "they are not connected";
  graph.add(relation(1, 9, sighting_of(4)));
  graph.add(relation(0, 8, sighting_of(2)));
  EXPECT_EQ(closures_between(graph, PatchId{0}, PatchId{12}), std::vector<ClosureId>{ClosureId{4}});
  EXPECT_EQ(closures_between(graph, PatchId{8}, PatchId{12}),
            (std::vector<ClosureId>{ClosureId{2}, ClosureId{4}}));
  EXPECT_TRUE(closures_between(graph, PatchId{9}, PatchId{12}).empty()) << "R2 knows that by itself";
}

// Those of one way are enough to find the closure without which two patches are parted.
TEST(ClosuresBetween, HaveAmongThemWhicheverWouldPartTheTwo) {
  RelationGraph graph = two_chains();
  graph.add(relation(1, 9, sighting_of(4)));
  graph.add(relation(8, 17, sighting_of(6)));
  graph.add(relation(2, 10, by_match));
  const Dependencies dependencies(graph);
  for (int a = 0; a < 9; ++a) {
    for (int b = 9; b < 18; ++b) {
      const std::vector<ClosureId> between = closures_between(graph, dependencies, PatchId{a}, PatchId{b});
      for (const ClosureId closure : {ClosureId{4}, ClosureId{6}}) {
        const RelationGraph rest = without(graph, dependencies, closure);
        if (rest.island(PatchId{a}) == rest.island(PatchId{b})) continue;
        EXPECT_TRUE(std::ranges::binary_search(between, closure)) << a << " " << b;
      }
    }
  }
}

TEST(KnownNear, IsByWallsForMatchesAndByAnythingForSightings) {
  RelationGraph graph = two_chains();
  graph.add(relation(0, 8, by_sighting));
  EXPECT_FALSE(known_near(graph, relation(1, 8, by_match)));
  EXPECT_TRUE(known_near(graph, relation(1, 8, by_sighting)));
  EXPECT_TRUE(known_near(graph, relation(1, 5, by_match)));
  EXPECT_FALSE(known_near(graph, relation(1, 6, by_match)));
}

// What came later is no reason for what was there.
TEST(Dependencies, AreOnWhatWasThereBefore) {
  RelationGraph graph = two_chains();
  graph.add(relation(1, 9, sighting_of(4)));
  const RelationId first = graph.add(relation(2, 10, by_match));
  graph.add(relation(1, 9, {OriginKind::start, {}}));
  const RelationId second = graph.add(relation(3, 11, by_match));
  EXPECT_EQ(of(graph, first), std::vector<int>{4});
  EXPECT_NE(of(graph, second), std::vector<int>{});  // a start says nothing of walls
}

}  // namespace
}  // namespace isthmus
