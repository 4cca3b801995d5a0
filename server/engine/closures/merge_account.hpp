#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "server/engine/closures/closure_ledger.hpp"
#include "server/engine/robot/world.hpp"
#include "server/engine/sightings/mutual_observations.hpp"

namespace isthmus {

/// What speaks for and against a merge that the map has taken over. Sightings that are false agree with one
/// another no oftener than chance has it, so that each that agrees weighs alike, on either side.
struct MergeAccount {
  ClosureId merge;
  /// The sightings that it was made of, places that matched on its trial, and sightings that it made the map
  /// agree with since.
  std::size_t supporting = 0;
  /// Sightings that agree with one another in loops that the map refused, and that it would not have refused
  /// without this merge: their ends would be on two islands.
  std::size_t contradicting = 0;
  /// Of the supporting ones those that the map agreed with since, as records of the log.
  std::vector<std::size_t> agreed;
};

/// After a trial has refused a loop that sightings propose: the account of the merge that is contradicted
/// most, if one is contradicted more than supported.
std::optional<MergeAccount> contradicted_merge(const World& world, const TagPatches& tags,
                                               const ClosureLedger& ledger,
                                               const MutualObservations& observations,
                                               const ClosureLedger::Entry& refused);

}  // namespace isthmus
