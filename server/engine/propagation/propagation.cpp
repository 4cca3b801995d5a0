#include "server/engine/propagation/propagation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/engine/map/local_loop.hpp"

namespace isthmus {
namespace {

bool matched_before(const RelationGraph& graph, PatchId a, PatchId b) {
  const std::vector<RelationId> between = graph.between(a, b);
  return std::ranges::any_of(between, [&](RelationId id) { return is_match(*graph.find(id)); });
}

// Where a candidate is well determined, it must also show what the scan sees.
bool shows(const Map& map, const Determined& determined, std::span<const ScanPoint> points,
           const EngineOptions& options) {
  const Pose other_from_patch = inverse(determined.local_from_patch);
  return overlap_share(map.manifold().patch(determined.patch), other_from_patch, points,
                       options.surroundings) >= options.surroundings.min_overlap;
}

}  // namespace

void Propagation::enqueue(PatchId patch, const PropagationOptions& options) {
  Visits& its = visits(patch);
  if (its.queued || its.count >= options.max_visits) return;
  its.queued = true;
  queue_.push_back(patch);
}

Propagation::Visits& Propagation::visits(PatchId patch) {
  const auto at = static_cast<std::size_t>(patch.value);
  if (at >= visits_.size()) visits_.resize(at + 1);
  return visits_[at];
}

void Propagation::forget_visits() {
  for (Visits& visits : visits_) visits.count = 0;
}

std::vector<PatchId> Propagation::same_side(const Map& map, PatchId patch,
                                            const PropagationOptions& options) const {
  const RelationGraph& graph = before_ ? *before_ : map.graph();
  return graph.within_hops(patch, options.common.near_hops, says_where_walls_are);
}

std::vector<PatchId> Propagation::candidates(const Map& map, PatchId patch,
                                             const EngineOptions& options) const {
  const Manifold& manifold = map.manifold();
  const IslandId island = map.graph().island(patch);
  const Pose& pose = manifold.pose(patch);
  const double reach = options.surroundings.reach_m + options.propagation.slack_m;
  std::vector<PatchId> near;
  std::vector<PatchId> own;
  const std::size_t known = before_ ? before_->patch_count() : manifold.size();
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(known); ++i) {
    const PatchId other{i};
    const Pose& its = manifold.pose(other);
    if (std::abs(its.x - pose.x) > reach || std::abs(its.y - pose.y) > reach) continue;
    if (other == patch || map.graph().island(other) != island) continue;
    if (manifold.patch(other).points.empty()) continue;
    if (own.empty()) own = same_side(map, patch, options.propagation);
    if (std::ranges::binary_search(own, other)) continue;
    if (matched_before(map.graph(), patch, other)) continue;
    near.push_back(other);
  }
  return near;
}

/// Whether another patch that was matched found this one: what is left to compare it with then is at the edge
/// of its view, and tells little.
bool Propagation::is_joined(const Map& map, PatchId patch) const {
  return std::ranges::any_of(map.graph().of(patch),
                             [&](RelationId id) { return map.graph().find(id)->origin == origin_; });
}

void Propagation::take_from_unmatched(PatchId patch) {
  if (std::exchange(visits(patch).unmatched, false)) std::erase(unmatched_, patch);
}

bool Propagation::step(Map& map, const EngineOptions& options) {
  const PatchId id = queue_.front();
  queue_.pop_front();
  ++steps_;
  ++visits(id).count;
  visits(id).queued = false;
  const Patch& patch = map.manifold().patch(id);
  if (static_cast<int>(patch.points.size()) < options.match.min_pairs) return false;
  const std::vector<PatchId> near = candidates(map, id, options);
  if (near.empty()) return false;
  Surroundings surroundings;
  surroundings.update(map, id, options, Surroundings::By::all);
  const auto is_wanted = [&](const Determined& determined) {
    if (!std::ranges::binary_search(near, determined.patch)) return false;
    if (!before_ && !determined.by_all_relations) return false;
    return !determined.by_all_relations || shows(map, determined, patch.points, options);
  };
  std::vector<PatchId> wanted;
  for (const Determined& determined : surroundings.patches())
    if (is_wanted(determined)) wanted.push_back(determined.patch);
  if (wanted.empty()) return false;
  std::ranges::sort(wanted);
  LoopQuery query;
  query.points = patch.points;
  query.among = [&](const Determined& determined) {
    return std::ranges::binary_search(wanted, determined.patch);
  };
  query.patch = id;
  query.origin = origin_;
  query.partly_known = true;
  const LocalLoop found = match_loop(map, surroundings, query, options);
  if (found.relations.empty() || (!before_ && !found.unambiguous)) {
    if (found.compared && found.unambiguous && !visits(id).matched && !visits(id).unmatched &&
        !is_joined(map, id)) {
      visits(id).unmatched = found.would_show;
      if (found.would_show)
        unmatched_.push_back(id);
      else if (before_)  // on trial: nobody else looks again, and without an end they would add up
        untold_.push_back(id);
    }
    return false;
  }
  if (!visits(id).matched) matched_.push_back(id);
  visits(id).matched = true;
  for (const Relation& relation : found.relations) {
    map.relate(relation);
    take_from_unmatched(relation.a);
    take_from_unmatched(relation.b);
  }
  map.refit_around(id, options.map_fit.window_patches);
  for (const PatchId next : map.graph().neighbours(id)) enqueue(next, options.propagation);
  return true;
}

void Propagation::retry(const PropagationOptions& options) {
  for (const PatchId id : std::vector<PatchId>(unmatched_)) enqueue(id, options);
  for (const PatchId id : std::exchange(untold_, {}))
    if (!visits(id).matched) enqueue(id, options);
}

}  // namespace isthmus
