#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <numeric>

#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

using namespace small_maps;

/// The graph as a plain list of pairs: the oracle.
struct PlainGraph {
  int patches = 0;
  std::map<RelationId, std::pair<int, int>> relations;

  /// The lowest patch of each patch's connected component.
  std::vector<int> components() const {
    std::vector<int> lowest(static_cast<std::size_t>(patches));
    std::iota(lowest.begin(), lowest.end(), 0);
    for (bool changed = true; changed;) {
      changed = false;
      for (const auto& [id, pair] : relations) {
        int& a = lowest[static_cast<std::size_t>(pair.first)];
        int& b = lowest[static_cast<std::size_t>(pair.second)];
        if (a == b) continue;
        a = b = std::min(a, b);
        changed = true;
      }
    }
    return lowest;
  }
};

void assert_same(const RelationGraph& graph, const PlainGraph& plain) {
  const std::vector<int> components = plain.components();
  std::map<int, std::vector<PatchId>> islands;
  for (int i = 0; i < plain.patches; ++i) {
    RC_ASSERT(graph.island(PatchId{i}).value == components[static_cast<std::size_t>(i)]);
    islands[components[static_cast<std::size_t>(i)]].push_back(PatchId{i});
  }
  std::vector<std::vector<PatchId>> wanted;
  for (const auto& [lowest, patches] : islands) {
    RC_ASSERT(graph.patches_of(PatchId{lowest}) == patches);
    wanted.push_back(patches);
  }
  RC_ASSERT(graph.islands() == wanted);
  RC_ASSERT(graph.relations().size() == plain.relations.size());
  auto at = plain.relations.begin();
  for (const auto& [id, relation] : graph.relations()) {
    RC_ASSERT(id == at->first);
    RC_ASSERT(std::pair(relation.a.value, relation.b.value) == at->second);
    ++at;
  }
}

TEST(RelationGraphProperty, IslandsAreTheConnectedComponentsWhateverIsRelatedAndRemoved) {
  EXPECT_TRUE(rc::check([] {
    RelationGraph graph;
    PlainGraph plain;
    const int acts = *rc::gen::inRange(1, 60);
    for (int i = 0; i < acts; ++i) {
      const int act = *rc::gen::inRange(0, 10);
      if (act < 3 || plain.patches < 2) {
        graph.add_patch(PatchId{plain.patches++});
      } else if (act < 7) {
        const int a = *rc::gen::inRange(0, plain.patches);
        const int b = *rc::gen::distinctFrom(rc::gen::inRange(0, plain.patches), a);
        plain.relations[graph.add(relation(a, b, RelativePose{}))] = {a, b};
      } else if (!plain.relations.empty()) {
        std::vector<RelationId> all, gone;
        for (const auto& [id, pair] : plain.relations) all.push_back(id);
        const int count = *rc::gen::inRange(1, 4);
        for (int k = 0; k < count; ++k) gone.push_back(*rc::gen::elementOf(all));
        graph.remove(gone);
        for (const RelationId id : gone) plain.relations.erase(id);
      }
      assert_same(graph, plain);
    }
  }));
}

TEST(RelationGraphProperty, WithinHopsIsWhatHopsSayWhereAllRelationsCount) {
  EXPECT_TRUE(rc::check([] {
    const int patches = *rc::gen::inRange(2, 20);
    SmallMap map(patches);
    const int relations = *rc::gen::inRange(0, 30);
    for (int i = 0; i < relations; ++i) {
      const int a = *rc::gen::inRange(0, patches);
      const int b = *rc::gen::distinctFrom(rc::gen::inRange(0, patches), a);
      map.graph.add(relation(a, b, RelativePose{}));
    }
    const PatchId from{*rc::gen::inRange(0, patches)};
    const int limit = *rc::gen::inRange(0, 5);
    std::vector<PatchId> wanted;
    for (int i = 0; i < patches; ++i)
      if (map.graph.hops(from, PatchId{i}, limit)) wanted.push_back(PatchId{i});
    RC_ASSERT(map.graph.within_hops(from, limit, [](const Relation&) { return true; }) == wanted);
  }));
}

}  // namespace
}  // namespace isthmus
