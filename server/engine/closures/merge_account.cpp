#include "server/engine/closures/merge_account.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "server/engine/propagation/trial.hpp"

namespace isthmus {
namespace {

using Entry = ClosureLedger::Entry;

// Sightings that agree with one another, but on trial not with what else was known.
bool is_refused_by_trial(const Entry& entry, ClosureKind kind) {
  return entry.record.kind == kind && entry.record.state == ClosureState::refused &&
         !entry.record.from_scans && is_refusal_by_trial(entry.record.reason);
}

bool is_accepted_merge(const Entry& entry) {
  return entry.record.kind == ClosureKind::merge && entry.record.state == ClosureState::accepted;
}

bool is_contradiction(const Entry& entry) { return is_refused_by_trial(entry, ClosureKind::loop); }

std::size_t contradicting(const ClosureLedger& ledger, const RelationGraph& graph, const Parting& parting) {
  std::set<std::size_t> records;
  std::set<std::size_t> wrong;
  for (const auto& [id, entry] : ledger.entries()) {
    const bool as_merge = is_refused_by_trial(entry, ClosureKind::merge);
    if (!as_merge && !is_contradiction(entry)) continue;
    if (!parting.has_apart(graph, entry.record.joining.first, entry.record.joining.second)) continue;
    for (const Evidence& evidence : entry.evidence) (as_merge ? wrong : records).insert(evidence.record);
  }
  return static_cast<std::size_t>(
      std::ranges::count_if(records, [&](std::size_t record) { return !wrong.contains(record); }));
}

std::vector<std::size_t> agreed(const World& world, const TagPatches& tags,
                                const MutualObservations& observations, const Parting& parting) {
  std::vector<std::size_t> records;
  for (std::size_t i = 0; i < observations.log().size(); ++i) {
    const SightingRecord record = observations.log()[i];
    if (record.verdict != Verdict::accepted || record.reason != Reason::agrees_with_map) continue;
    const std::optional<Evidence> evidence = observations.placed_again(world, tags, i);
    if (evidence && evidence->target_place &&
        parting.has_apart(world.map.graph(), evidence->observer.pose.patch,
                          evidence->target_place->pose.patch))
      records.push_back(i);
  }
  return records;
}

// How much matches says that the two maps are of ground that is alike. That there is no other ground like it,
// it says only as far as buildings are rare that are the same twice.
double by_what_matches(const TrialAccount& account, const TrialOptions& its) {
  return std::clamp(account.shared_log_odds + account.fit_log_odds, 0.0, -std::log(its.repeats_probability));
}

}  // namespace

std::optional<PartingQuestion> doubted_by_sightings(const ClosureLedger& ledger, const Entry& refused) {
  if (!is_contradiction(refused)) return std::nullopt;
  PartingQuestion question{refused.record.joining, {}};
  for (const auto& [id, entry] : ledger.entries())
    if (is_accepted_merge(entry)) question.merges.insert(id);
  if (question.merges.empty()) return std::nullopt;
  return question;
}

std::optional<MergeAccount> contradicted_merge(const World& world, const TagPatches& tags,
                                               const ClosureLedger& ledger,
                                               const MutualObservations& observations,
                                               std::span<const Parting> partings) {
  const TrialOptions& its = world.options.trial;
  std::optional<MergeAccount> worst;
  for (const Parting& parting : partings) {
    const Entry* merge = ledger.find(parting.merge);
    if (merge == nullptr || !is_accepted_merge(*merge)) continue;
    MergeAccount account{
        parting.merge,
        log_odds_of_agreeing(merge->evidence.size(), its) + by_what_matches(merge->record.account, its),
        log_odds_of_agreeing(contradicting(ledger, world.map.graph(), parting), its),
        {}};
    if (account.contradicting <= account.supporting) continue;
    account.agreed = agreed(world, tags, observations, parting);
    account.supporting = log_odds_of_agreeing(merge->evidence.size() + account.agreed.size(), its) +
                         by_what_matches(merge->record.account, its);
    if (account.contradicting <= account.supporting) continue;
    if (!worst || account.contradicting - account.supporting > worst->contradicting - worst->supporting)
      worst = std::move(account);
  }
  return worst;
}

}  // namespace isthmus
