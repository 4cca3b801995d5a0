#include "server/engine/closures/merge_account.hpp"

#include <set>

#include "server/engine/map/dependencies.hpp"

namespace isthmus {
namespace {

using Entry = ClosureLedger::Entry;

// A loop of sightings that agree with one another, but not with the map as it is.
bool is_contradiction(const Entry& entry) {
  return entry.record.kind == ClosureKind::loop && entry.record.state == ClosureState::refused &&
         !entry.record.from_scans && is_refusal_by_trial(entry.record.reason);
}

RelationGraph without(const RelationGraph& graph, const Dependencies& dependencies, ClosureId closure) {
  std::vector<RelationId> out;
  for (const auto& [id, relation] : graph.relations())
    if (dependencies.has(id, closure)) out.push_back(id);
  RelationGraph rest = graph;
  rest.remove(out);
  return rest;
}

bool parted(const RelationGraph& graph, PatchId a, PatchId b) { return graph.island(a) != graph.island(b); }

bool parted(const RelationGraph& graph, const Evidence& evidence) {
  return evidence.target_place &&
         parted(graph, evidence.observer.pose.patch, evidence.target_place->pose.patch);
}

std::size_t contradicting(const ClosureLedger& ledger, const RelationGraph& rest) {
  std::set<std::size_t> records;
  for (const auto& [id, entry] : ledger.entries()) {
    if (!is_contradiction(entry) || !parted(rest, entry.record.joining.first, entry.record.joining.second))
      continue;
    for (const Evidence& evidence : entry.evidence) records.insert(evidence.record);
  }
  return records.size();
}

std::vector<std::size_t> agreed(const World& world, const TagPatches& tags,
                                const MutualObservations& observations, const RelationGraph& rest) {
  std::vector<std::size_t> records;
  for (std::size_t i = 0; i < observations.log().size(); ++i) {
    const SightingRecord record = observations.log()[i];
    if (record.verdict != Verdict::accepted || record.reason != Reason::agrees_with_map) continue;
    const std::optional<Evidence> evidence = observations.placed_again(world, tags, i);
    if (evidence && parted(rest, *evidence)) records.push_back(i);
  }
  return records;
}

// What there is without having looked at every sighting.
std::size_t supporting_at_once(const Entry& merge) {
  return merge.evidence.size() + static_cast<std::size_t>(merge.record.patches_touched);
}

}  // namespace

std::optional<MergeAccount> contradicted_merge(const World& world, const TagPatches& tags,
                                               const ClosureLedger& ledger,
                                               const MutualObservations& observations, const Entry& refused) {
  if (!is_contradiction(refused)) return std::nullopt;
  const RelationGraph& graph = world.map.graph();
  const Dependencies dependencies(graph);
  std::optional<MergeAccount> worst;
  for (const auto& [id, merge] : ledger.entries()) {
    if (merge.record.kind != ClosureKind::merge || merge.record.state != ClosureState::accepted) continue;
    const RelationGraph rest = without(graph, dependencies, id);
    if (!parted(rest, refused.record.joining.first, refused.record.joining.second)) continue;
    MergeAccount account{id, supporting_at_once(merge), contradicting(ledger, rest), {}};
    if (account.contradicting <= account.supporting) continue;
    account.agreed = agreed(world, tags, observations, rest);
    account.supporting += account.agreed.size();
    if (account.contradicting <= account.supporting) continue;
    if (!worst || account.contradicting - account.supporting > worst->contradicting - worst->supporting)
      worst = std::move(account);
  }
  return worst;
}

}  // namespace isthmus
