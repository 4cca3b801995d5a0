#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "server/engine/closures/closure_ledger.hpp"
#include "server/engine/closures/parting.hpp"
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

/// What to ask of the map after a trial has refused a loop that sightings propose; nothing where no merge can
/// be wrong by it.
std::optional<PartingQuestion> doubted_by_sightings(const ClosureLedger& ledger,
                                                    const ClosureLedger::Entry& refused);

/// Of the merges without which its ends were on two islands: the account of the one that is contradicted
/// most, if one is contradicted more than supported.
std::optional<MergeAccount> contradicted_merge(const World& world, const TagPatches& tags,
                                               const ClosureLedger& ledger,
                                               const MutualObservations& observations,
                                               std::span<const Parting> partings);

}  // namespace isthmus
