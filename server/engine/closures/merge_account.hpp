#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "server/engine/closures/closure_ledger.hpp"
#include "server/engine/robot/world.hpp"
#include "server/engine/sightings/mutual_observations.hpp"

namespace isthmus {

/// What speaks for and against a merge that the map has taken over, as log-odds. Sightings that are false
/// agree with one another no oftener than chance has it: each that agrees beyond two weighs alike, on either
/// side.
struct MergeAccount {
  ClosureId merge;
  /// By the sightings that it was made of and those that it made the map agree with since, and by how much of
  /// the two maps matched on its trial: no more than buildings are rare that are the same twice.
  double supporting = 0;
  /// By sightings that agree with one another in loops that the map refused, and that it would not have
  /// refused without this merge: their ends would be on two islands. What has been refused as a merge of the
  /// two is left out: it is wrong with this one or without.
  double contradicting = 0;
  /// Of the supporting sightings those that the map agreed with since, as records of the log.
  std::vector<std::size_t> agreed;
};

/// After a trial has refused a loop that sightings propose: the account of the merge that is contradicted
/// most, if one is contradicted more than supported.
std::optional<MergeAccount> contradicted_merge(const World& world, const TagPatches& tags,
                                               const ClosureLedger& ledger,
                                               const MutualObservations& observations,
                                               const ClosureLedger::Entry& refused);

}  // namespace isthmus
