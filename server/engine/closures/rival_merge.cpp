#include "server/engine/closures/rival_merge.hpp"

#include <set>
#include <span>
#include <vector>

#include "server/engine/map/dependencies.hpp"
#include "server/engine/map/drift.hpp"
#include "server/engine/map/local_loop.hpp"
#include "server/engine/map/ways.hpp"
#include "server/engine/propagation/shared_part.hpp"
#include "server/engine/propagation/trial.hpp"

namespace isthmus {
namespace {

using Entry = ClosureLedger::Entry;

/// Two maps laid over one another.
struct Overlay {
  double matched_m = 0;    ///< way on which they match,
  double unmatched_m = 0;  ///< and on which they do not, although both know the ground
  double width_m = 0;      ///< of what matches, across its length
};

double log_odds(const Overlay& overlay, const TrialAccount& account, const TrialOptions& its) {
  return account.prior_log_odds + account.fit_log_odds + its.log_odds_per_way_m * overlay.matched_m +
         its.log_odds_per_width_m * overlay.width_m - its.log_odds_per_unmatched_m * overlay.unmatched_m;
}

bool may_rival(const Entry& entry, const TrialOptions& its) {
  return entry.record.kind == ClosureKind::loop && entry.record.from_scans &&
         entry.record.state != ClosureState::accepted &&
         entry.record.account.matched >= its.few_matched_scans;
}

bool may_be_wrong(const Entry& entry) {
  return entry.record.kind == ClosureKind::merge && entry.record.state == ClosureState::accepted &&
         entry.record.reason != Reason::measured_start;
}

// Whether a map that drifts cannot have both.
bool is_elsewhere(const Map& map, const Joining& joining, const EngineOptions& options) {
  const double way_m = ways_over_relations_m(map, std::span(&joining.first, 1))[index(joining.second)];
  const Eigen::Vector3d off =
      wrapped_difference(joining.first_from_second, map.relative_pose(joining.first, joining.second));
  const Eigen::Vector3d variance = drift_variance(way_m, options.place_candidates);
  return off.cwiseAbs2().cwiseQuotient(variance).sum() > options.trial.max_jump.bound(3);
}

Overlay on_trial(const TrialAccount& account) {
  return {account.way_m, account.unmatched_m, account.width_m};
}

// As far from what matches as the map cannot have bent: beyond, a loop may be open.
Overlay as_it_lies(const Map& map, const RelationGraph& apart, const Joining& joining,
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

// By so much as a loop must be likely, or the one would be accepted now and the other no more.
bool is_likelier(const RivalledMerge& found, double enough) {
  return found.as_rival - found.as_it_lies >= enough ||
         (found.as_rival >= enough && found.as_it_lies < enough);
}

}  // namespace

std::optional<RivalledMerge> rivalled_merge(const World& world, const ClosureLedger& ledger,
                                            const Entry& rival) {
  const TrialOptions& its = world.options.trial;
  const Joining& joining = rival.record.joining;
  if (!may_rival(rival, its) || !is_elsewhere(world.map, joining, world.options)) return std::nullopt;
  const RelationGraph& graph = world.map.graph();
  const Dependencies dependencies(graph);
  const double as_rival = log_odds(on_trial(rival.record.account), rival.record.account, its);
  std::optional<RivalledMerge> least;
  for (const ClosureId id : closures_between(graph, dependencies, joining.first, joining.second)) {
    const Entry* merge = ledger.find(id);
    if (merge == nullptr || !may_be_wrong(*merge)) continue;
    const RelationGraph apart = without(graph, dependencies, id);
    if (apart.island(joining.first) == apart.island(joining.second)) continue;
    const Overlay overlay = as_it_lies(world.map, apart, joining, world.options);
    const RivalledMerge found{
        id, log_odds(overlay, merge->record.account, its) + log_odds_of_agreeing(merge->evidence.size(), its),
        as_rival};
    if (!is_likelier(found, its.min_loop_log_odds)) continue;
    if (!least || found.as_it_lies < least->as_it_lies) least = found;
  }
  return least;
}

}  // namespace isthmus
