#pragma once

#include <optional>
#include <span>

#include "server/engine/closures/closure_ledger.hpp"
#include "server/engine/closures/parting.hpp"

namespace isthmus {

/// A merge that the map has taken over, and another way in which scans lay the same two maps over one
/// another: log-odds of either, by the way on which they match and that on which they do not although both
/// know the ground.
struct RivalledMerge {
  ClosureId merge;
  double as_it_lies = 0;  ///< by all that lies over one another now, and its sightings
  double as_rival = 0;
};

/// What to ask of the map after a trial has not accepted a loop that scans propose; nothing where no merge
/// can be wrong by it. Measured starts are not.
std::optional<PartingQuestion> doubted_by_scans(const ClosureLedger& ledger,
                                                const ClosureLedger::Entry& rival,
                                                const TrialOptions& options);

/// Of the merges that brought its ends to one island, and that have them elsewhere than drift explains: the
/// one that has least for it, if the loop would have so much more as a merge of the two maps
/// (`trial.min_loop_log_odds`), or so much at all where the merge has it no more.
std::optional<RivalledMerge> rivalled_merge(const ClosureLedger& ledger, const ClosureLedger::Entry& rival,
                                            std::span<const Parting> partings, const TrialOptions& options);

}  // namespace isthmus
