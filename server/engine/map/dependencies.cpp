#include "server/engine/map/dependencies.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "relations/disjoint_sets.hpp"
#include "server/engine/map/surroundings.hpp"

namespace isthmus {
namespace {

using ClosureSet = std::vector<ClosureId>;

bool needs_no_map(const Relation& relation) {
  return relation.origin.kind == OriginKind::odometry || relation.origin.kind == OriginKind::start;
}

/// Searches a graph as it was before each of its relations was made.
class PastGraph {
 public:
  explicit PastGraph(const RelationGraph& graph) : graph_(graph), reached_(graph.patch_count()) {}

  /// The relations of the shortest way between a relation's ends that was there before it, along those that
  /// `along` says yes to; nothing where there is none of at most so many.
  template <class Along>
  std::optional<std::vector<RelationId>> way(const Relation& relation, std::size_t max_hops,
                                             const Along& along) {
    ++search_;
    std::vector<PatchId> level{relation.a};
    reached_[index(relation.a)] = {search_, {}};
    for (std::size_t hops = 0; hops < max_hops && !level.empty(); ++hops) {
      std::vector<PatchId> next;
      for (const PatchId patch : level) {
        for (const RelationId id : graph_.of(patch)) {
          if (!(id < relation.id)) break;
          const Relation& link = *graph_.find(id);
          const PatchId other = link.a == patch ? link.b : link.a;
          if (reached_[index(other)].search == search_ || !along(link)) continue;
          reached_[index(other)] = {search_, id};
          if (other == relation.b) return way_back(relation);
          next.push_back(other);
        }
      }
      level = std::move(next);
    }
    return std::nullopt;
  }

 private:
  struct Reached {
    std::int32_t search = 0;
    RelationId by;
  };

  std::vector<RelationId> way_back(const Relation& relation) const {
    std::vector<RelationId> way;
    for (PatchId at = relation.b; at != relation.a;) {
      const Relation& link = *graph_.find(reached_[index(at)].by);
      way.push_back(link.id);
      at = link.a == at ? link.b : link.a;
    }
    return way;
  }

  const RelationGraph& graph_;
  std::vector<Reached> reached_;  // by patch id
  std::int32_t search_ = 0;
};

}  // namespace

bool carries(const Relation& link, const Relation& what) {
  return !is_match(what) || says_where_walls_are(link);
}

bool known_near(const RelationGraph& graph, const Relation& relation) {
  const std::vector<PatchId> near = graph.within_hops(
      relation.a, known_near_hops, [&](const Relation& link) { return carries(link, relation); });
  return std::ranges::binary_search(near, relation.b);
}

Dependencies::Dependencies(const RelationGraph& graph) : sets_(1) {
  PastGraph past(graph);
  std::map<ClosureSet, std::uint32_t> numbers{{{}, 0}};
  // Parts that hold together by what depends on nothing: between two of them no way need be looked for.
  std::vector<PatchId> parents(graph.patch_count());
  std::ranges::generate(parents, [next = 0]() mutable { return PatchId{next++}; });
  DisjointSets<PatchId> parts(parents);
  bool any_closure = false;
  for (const auto& [id, relation] : graph.relations()) {
    set_of_.resize(index(id) + 1, 0);
    any_closure = any_closure || relation.origin.closure.valid();
    std::set<ClosureId> closures;
    if (relation.origin.closure.valid()) closures.insert(relation.origin.closure);
    const auto is_near_independently = [&, &measured = relation] {
      return parts.lowest(measured.a) == parts.lowest(measured.b) &&
             past.way(measured, known_near_hops, [&](const Relation& link) {
               return set_of_[index(link.id)] == 0 && carries(link, measured);
             });
    };
    if (any_closure && !needs_no_map(relation) && !is_near_independently()) {
      const auto anything = [](const Relation&) { return true; };
      const auto way = past.way(relation, graph.patch_count(), anything);
      for (const RelationId link : way.value_or(std::vector<RelationId>{}))
        for (const ClosureId closure : of(link)) closures.insert(closure);
    }
    if (closures.empty()) parts.join(relation.a, relation.b);
    const auto [set, is_new] =
        numbers.try_emplace(ClosureSet(closures.begin(), closures.end()), sets_.size());
    if (is_new) sets_.push_back(set->first);
    set_of_[index(id)] = set->second;
  }
}

std::span<const ClosureId> Dependencies::of(RelationId id) const {
  return id.valid() && index(id) < set_of_.size() ? sets_[set_of_[index(id)]] : sets_.front();
}

bool Dependencies::has(RelationId id, ClosureId closure) const {
  return std::ranges::binary_search(of(id), closure);
}

RelationGraph without(const RelationGraph& graph, const Dependencies& dependencies, ClosureId closure) {
  std::vector<RelationId> out;
  for (const auto& [id, relation] : graph.relations())
    if (dependencies.has(id, closure)) out.push_back(id);
  RelationGraph rest = graph;
  rest.remove(out);
  return rest;
}

std::vector<ClosureId> closures_between(const RelationGraph& graph, PatchId a, PatchId b) {
  return closures_between(graph, Dependencies(graph), a, b);
}

std::vector<ClosureId> closures_between(const RelationGraph& graph, const Dependencies& dependencies,
                                        PatchId a, PatchId b) {
  Relation newest;
  newest.id = RelationId{std::numeric_limits<std::int32_t>::max()};
  newest.a = a;
  newest.b = b;
  const auto anything = [](const Relation&) { return true; };
  const auto way = PastGraph(graph).way(newest, graph.patch_count(), anything);
  if (!way) return {};
  std::set<ClosureId> closures;
  for (const RelationId link : *way)
    for (const ClosureId closure : dependencies.of(link)) closures.insert(closure);
  return {closures.begin(), closures.end()};
}

}  // namespace isthmus
