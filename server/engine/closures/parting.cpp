#include "server/engine/closures/parting.hpp"

#include <span>
#include <utility>

#include "server/engine/map/dependencies.hpp"
#include "server/engine/map/drift.hpp"
#include "server/engine/map/local_loop.hpp"
#include "server/engine/map/ways.hpp"
#include "server/engine/propagation/shared_part.hpp"

namespace isthmus {
namespace {

// Whether a map that drifts cannot have both.
bool is_elsewhere(const Map& map, const Joining& joining, const EngineOptions& options) {
  const double way_m = ways_over_relations_m(map, std::span(&joining.first, 1))[index(joining.second)];
  const Eigen::Vector3d off =
      wrapped_difference(joining.first_from_second, map.relative_pose(joining.first, joining.second));
  const Eigen::Vector3d variance = drift_variance(way_m, options.place_candidates);
  return off.cwiseAbs2().cwiseQuotient(variance).sum() > options.trial.max_jump.bound(3);
}

// As far from what matches as the map cannot have bent: beyond, a loop may be open.
Overlay overlay_of(const Map& map, const RelationGraph& apart, const Joining& joining,
                   const EngineOptions& options) {
  const IslandId first = apart.island(joining.first), second = apart.island(joining.second);
  const auto joins_the_two = [&](const Relation& relation) {
    const IslandId of_a = apart.island(relation.a), of_b = apart.island(relation.b);
    return is_match(relation) && ((of_a == first && of_b == second) || (of_a == second && of_b == first));
  };
  std::set<PatchId> ends;
  for (const auto& [id, relation] : map.graph().relations())
    if (joins_the_two(relation)) ends.insert({relation.a, relation.b});
  const std::vector<PatchId> matched(ends.begin(), ends.end());
  const std::vector<double> ways_m = ways_over_relations_m(map, matched);
  const auto may_have_bent = [&](PatchId id) {
    const double deep_m = options.contradiction.deep_m;
    return !(systematic_variance(2 * ways_m[index(id)], options.place_candidates).x() < deep_m * deep_m);
  };
  std::vector<PatchId> known_to_both =
      overlapping(map, apart.patches_of(first), apart.patches_of(second), options);
  std::erase_if(known_to_both, may_have_bent);
  return {way_m(map, matched, options.shared_part),
          unmatched_way_m(map, apart, known_to_both, matched, options), width_m(map, matched)};
}

}  // namespace

bool Parting::has_apart(const RelationGraph& graph, PatchId a, PatchId b) const {
  const auto island = [&](PatchId id) {
    while (index(id) >= islands.size()) {
      const std::span<const RelationId> ties = graph.of(id);
      if (ties.empty()) return IslandId{id};
      const Relation& first = *graph.find(ties.front());
      const PatchId other = first.a == id ? first.b : first.a;
      if (!(other < id)) return IslandId{id};
      id = other;
    }
    return islands[index(id)];
  };
  return island(a) != island(b);
}

std::vector<Parting> partings(const Map& map, const PartingQuestion& question, const EngineOptions& options) {
  const Joining& joining = question.joining;
  if (question.only_elsewhere && !is_elsewhere(map, joining, options)) return {};
  const RelationGraph& graph = map.graph();
  const Dependencies dependencies(graph);
  std::vector<Parting> found;
  for (const ClosureId merge : closures_between(graph, dependencies, joining.first, joining.second)) {
    if (!question.merges.contains(merge)) continue;
    const RelationGraph apart = without(graph, dependencies, merge);
    if (apart.island(joining.first) == apart.island(joining.second)) continue;
    Parting& parting = found.emplace_back(Parting{merge, {}, {}});
    for (const PatchPtr& patch : map.manifold().patches()) parting.islands.push_back(apart.island(patch->id));
    if (question.with_overlay) parting.overlay = overlay_of(map, apart, joining, options);
  }
  return found;
}

PartingsJob::PartingsJob(const Map& map, PartingQuestion question, std::int64_t now_utime,
                         const EngineOptions& options)
    : due_utime_(now_utime +
                 static_cast<std::int64_t>(map.manifold().size()) * options.place_candidates.us_per_patch),
      partings_(std::async(std::launch::async, [map, question = std::move(question), options] {
        return isthmus::partings(map, question, options);
      })) {}

}  // namespace isthmus
