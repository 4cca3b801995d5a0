#include "server/engine/closures/rival_merge.hpp"

#include "server/engine/propagation/trial.hpp"

namespace isthmus {
namespace {

using Entry = ClosureLedger::Entry;

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

Overlay on_trial(const TrialAccount& account) {
  return {account.way_m, account.unmatched_m, account.width_m};
}

// By so much as a loop must be likely, or the one would be accepted now and the other no more.
bool is_likelier(const RivalledMerge& found, double enough) {
  return found.as_rival - found.as_it_lies >= enough ||
         (found.as_rival >= enough && found.as_it_lies < enough);
}

}  // namespace

std::optional<PartingQuestion> doubted_by_scans(const ClosureLedger& ledger, const Entry& rival,
                                                const TrialOptions& options) {
  if (!may_rival(rival, options)) return std::nullopt;
  PartingQuestion question{rival.record.joining, {}, true, true};
  for (const auto& [id, entry] : ledger.entries())
    if (may_be_wrong(entry)) question.merges.insert(id);
  if (question.merges.empty()) return std::nullopt;
  return question;
}

std::optional<RivalledMerge> rivalled_merge(const ClosureLedger& ledger, const Entry& rival,
                                            std::span<const Parting> partings, const TrialOptions& options) {
  if (!may_rival(rival, options)) return std::nullopt;
  const double as_rival = log_odds(on_trial(rival.record.account), rival.record.account, options);
  std::optional<RivalledMerge> least;
  for (const Parting& parting : partings) {
    const Entry* merge = ledger.find(parting.merge);
    if (merge == nullptr || !may_be_wrong(*merge)) continue;
    const RivalledMerge found{parting.merge,
                              log_odds(parting.overlay, merge->record.account, options) +
                                  log_odds_of_agreeing(merge->evidence.size(), options),
                              as_rival};
    if (!is_likelier(found, options.min_loop_log_odds)) continue;
    if (!least || found.as_it_lies < least->as_it_lies) least = found;
  }
  return least;
}

}  // namespace isthmus
