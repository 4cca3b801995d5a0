#pragma once

#include <optional>

#include "server/engine/closures/closure_ledger.hpp"
#include "server/engine/robot/world.hpp"

namespace isthmus {

/// A merge that the map has taken over, and another way in which scans lay the same two maps over one
/// another: log-odds of either, by the way on which they match and that on which they do not although both
/// know the ground.
struct RivalledMerge {
  ClosureId merge;
  double as_it_lies = 0;  ///< by all that lies over one another now, and its sightings
  double as_rival = 0;
};

/// After a trial has not accepted a loop that scans propose: the merge that brought its ends to one island
/// and that has them elsewhere than drift explains, if the loop would have so much more for it as a merge
/// of the two maps (`trial.min_loop_log_odds`), or so much at all where the merge has it no more. Of several
/// the one that has least. Measured starts stay.
std::optional<RivalledMerge> rivalled_merge(const World& world, const ClosureLedger& ledger,
                                            const ClosureLedger::Entry& rival);

}  // namespace isthmus
