#include "relations/graph.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "relations/disjoint_sets.hpp"

namespace isthmus {
namespace {

PatchId other_end(const Relation& relation, PatchId end) {
  return relation.a == end ? relation.b : relation.a;
}

std::string text(PatchId id) { return std::to_string(id.value); }

/// Breadth first from one patch, over the relations that `along` says yes to: the patches that were found, in
/// the order of finding. Each level is given to `go_on`, which may reorder it, before its neighbours are
/// looked at; false ends the search. (boost::breadth_first_search would want the graph in its own form.)
template <class Along, class GoOn>
std::vector<PatchId> breadth_first(const RelationGraph& graph, PatchId from, const Along& along,
                                   const GoOn& go_on) {
  std::vector<PatchId> found{from};
  std::vector<char> seen(graph.patch_count(), 0);
  seen[index(from)] = 1;
  for (std::size_t level = 0, end = 1; level < end && go_on(std::span(found).subspan(level));
       level = end, end = found.size()) {
    for (std::size_t i = level; i < end; ++i) {
      const PatchId patch = found[i];
      for (const RelationId id : graph.of(patch)) {
        const Relation* relation = graph.find(id);
        if (!relation) continue;
        const PatchId next = other_end(*relation, patch);
        if (seen[index(next)] || !along(*relation)) continue;
        seen[index(next)] = 1;
        found.push_back(next);
      }
    }
  }
  return found;
}

bool any_relation(const Relation&) { return true; }

void set_least(Relation& relation) {
  auto* correspondences = std::get_if<Correspondences>(&relation.measurement);
  if (correspondences) correspondences->least = correspondences->form.least();
}

}  // namespace

void RelationGraph::add_patch(PatchId id) {
  if (!id.valid() || index(id) != of_.size())
    throw std::invalid_argument("patch " + text(id) + " added to a graph of " + std::to_string(of_.size()));
  of_.push_back({});
  island_parent_.push_back(id);
}

void RelationGraph::check_ends(const Relation& relation) const {
  for (const PatchId end : {relation.a, relation.b})
    if (!end.valid() || index(end) >= of_.size())
      throw std::invalid_argument("relation of a patch " + text(end) + " that was never added");
  if (relation.a == relation.b)
    throw std::invalid_argument("relation of patch " + text(relation.a) + " with itself");
}

bool RelationGraph::is_sound() const {
  std::vector<std::vector<RelationId>> of(of_.size());
  std::size_t relations = 0;
  for (std::size_t i = 0; i < stored_.size(); ++i) {
    if (!stored_[i]) continue;
    const Relation& relation = *stored_[i];
    const auto is_here = [&](PatchId end) { return end.valid() && index(end) < of.size(); };
    if (index(relation.id) != i || !is_here(relation.a) || !is_here(relation.b) || relation.a == relation.b)
      return false;
    ++relations;
    for (const PatchId end : {relation.a, relation.b}) of[index(end)].push_back(relation.id);
  }
  if (relations != relation_count_ || island_parent_.size() != of_.size()) return false;
  for (std::size_t i = 0; i < of.size(); ++i)
    if (of[i] != of_[i]) return false;
  // No parent is above its child, or the way to an island's lowest id would not end.
  for (std::size_t i = 0; i < of_.size(); ++i)
    if (!island_parent_[i].valid() || index(island_parent_[i]) > i) return false;
  RelationGraph again = *this;
  again.find_islands();
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(of_.size()); ++i)
    if (island(PatchId{i}) != again.island(PatchId{i})) return false;
  return true;
}

RelationId RelationGraph::add(Relation relation) {
  check_ends(relation);
  relation.id = RelationId{static_cast<std::int32_t>(stored_.size())};
  set_least(relation);
  of_.own(index(relation.a)).push_back(relation.id);
  of_.own(index(relation.b)).push_back(relation.id);
  DisjointSets(island_parent_).join(relation.a, relation.b);
  ++relation_count_;
  const RelationId id = relation.id;
  stored_.push_back(std::make_shared<const Relation>(std::move(relation)));
  return id;
}

/// Whether the islands may have parted: not where the two patches are still joined by a short way.
bool RelationGraph::take_away(RelationId id) {
  const Relation* relation = find(id);
  if (!relation) return false;
  const PatchId a = relation->a;
  const PatchId b = relation->b;
  for (const PatchId end : {a, b}) std::erase(of_.own(index(end)), id);
  stored_.own(index(id)).reset();
  --relation_count_;
  return !hops(a, b, 2);
}

void RelationGraph::remove(RelationId id) { remove(std::span(&id, 1)); }

void RelationGraph::remove(std::span<const RelationId> ids) {
  bool may_part = false;
  for (const RelationId id : ids) may_part = take_away(id) || may_part;
  if (may_part) find_islands();
}

const Relation* RelationGraph::find(RelationId id) const {
  return id.valid() && index(id) < stored_.size() ? stored_[index(id)].get() : nullptr;
}

std::span<const RelationId> RelationGraph::of(PatchId id) const {
  if (!id.valid() || index(id) >= of_.size()) return {};
  return of_[index(id)];
}

std::vector<RelationId> RelationGraph::between(PatchId a, PatchId b) const {
  std::vector<RelationId> found;
  for (const RelationId id : of(a))
    if (other_end(stored(id), a) == b) found.push_back(id);
  return found;
}

std::vector<PatchId> RelationGraph::neighbours(PatchId id) const {
  std::vector<PatchId> found;
  for (const RelationId relation : of(id)) found.push_back(other_end(stored(relation), id));
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

IslandId RelationGraph::island(PatchId id) const {
  while (island_parent_.at(index(id)) != id) id = island_parent_[index(id)];
  return id;
}

std::vector<std::vector<PatchId>> RelationGraph::islands() const {
  std::vector<std::vector<PatchId>> found;
  std::vector<std::size_t> place(of_.size());
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(of_.size()); ++i) {
    const PatchId patch{i};
    const IslandId lowest = island(patch);
    if (lowest == patch) {
      place[index(patch)] = found.size();
      found.emplace_back();
    }
    found[place[index(lowest)]].push_back(patch);
  }
  return found;
}

std::vector<PatchId> RelationGraph::patches_of(IslandId wanted) const {
  std::vector<PatchId> found;
  for (std::int32_t i = std::max(wanted.value, 0); i < static_cast<std::int32_t>(of_.size()); ++i)
    if (island(PatchId{i}) == wanted) found.push_back(PatchId{i});
  return found;
}

std::vector<PatchId> RelationGraph::nearest_in_graph(PatchId from, std::size_t max_patches) const {
  if (max_patches == 0) return {};
  std::size_t count = 0;
  std::vector<PatchId> found = breadth_first(*this, from, any_relation, [&](std::span<PatchId> level) {
    std::sort(level.begin(), level.end());
    count += level.size();
    return count < max_patches;
  });
  if (found.size() > max_patches) found.resize(max_patches);
  return found;
}

std::vector<PatchId> RelationGraph::within_hops(PatchId from, int limit,
                                                const std::function<bool(const Relation&)>& along) const {
  int distance = 0;
  std::vector<PatchId> found =
      breadth_first(*this, from, along, [&](std::span<PatchId>) { return distance++ < limit; });
  std::sort(found.begin(), found.end());
  return found;
}

std::optional<int> RelationGraph::hops(PatchId a, PatchId b, int limit) const {
  std::optional<int> found;
  int distance = 0;
  breadth_first(*this, a, any_relation, [&](std::span<PatchId> level) {
    if (distance <= limit && std::find(level.begin(), level.end(), b) != level.end()) found = distance;
    return !found && distance++ < limit;
  });
  return found;
}

void RelationGraph::find_islands() {
  for (std::size_t i = 0; i < island_parent_.size(); ++i)
    island_parent_[i] = PatchId{static_cast<std::int32_t>(i)};
  DisjointSets islands(island_parent_);
  for (const auto& [id, relation] : relations()) islands.join(relation.a, relation.b);
  for (PatchId& parent : island_parent_)
    parent = island_parent_[index(parent)];  // the lowest has come before
}

}  // namespace isthmus
