#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/engine/closures/closure_record.hpp"
#include "server/engine/closures/joining.hpp"
#include "server/engine/closures/scan_proposal.hpp"
#include "server/engine/closures/sighting_groups.hpp"
#include "server/engine/closures/sighting_proposer.hpp"
#include "server/engine/propagation/trial.hpp"

namespace isthmus {

/// A closure as it is proposed: what its trial begins with, and its record.
struct ClosureDraft {
  Proposal proposal;
  ClosureRecord record;
};

/// By the sightings of a group that agree. Without relations where each has both its ends on one patch.
ClosureDraft draft_of_sightings(const Map& map, ClosureId id, const SightingGroup& group,
                                const GroupAgreement& agreement, const std::vector<Evidence>& supporters,
                                std::int64_t now_utime, const EngineOptions& options);

/// By finds of scans; a new one, whatever the id that they name.
ClosureDraft draft_of_finds(const Map& map, ClosureId id, const ScanProposal& finds, std::int64_t now_utime,
                            const EngineOptions& options);

/// By a measured start: a relative pose between two robots' first patches. It needs no trial of its truth.
ClosureDraft draft_of_start(const Map& map, ClosureId id, const Relation& start,
                            std::vector<std::string> robots, std::int64_t now_utime);

}  // namespace isthmus
