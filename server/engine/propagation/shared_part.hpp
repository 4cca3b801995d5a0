#pragma once

#include <functional>
#include <span>
#include <vector>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {

/// What each of two maps, laid over one another, has for itself, and where they do not fit.
struct SharedPart {
  double own_first_m = 0;  ///< way of either that is nowhere near the other's
  double own_second_m = 0;
  double border_contradiction = 0;  ///< mean share of hits deep in the other's free space, where views meet
};

/// Way on which patches lie, however often it was driven.
double way_m(const Map& map, std::span<const PatchId> patches, const SharedPartOptions& options);

/// Of the way on which `known` lie, places where nothing matches: no patch there is among `matched`, nor is
/// one of those beside it on its own way, a few relations away in the graph without what is tried.
double unmatched_way_m(const Map& map, const RelationGraph& apart, std::span<const PatchId> known,
                       std::span<const PatchId> matched, const EngineOptions& options);

/// How wide patches lie across their length: next to nothing along one corridor.
double width_m(const Map& map, std::span<const PatchId> patches);

/// Patches of either of two maps, laid over one another, that lie within a local map of one of the other.
std::vector<PatchId> overlapping(const Map& map, std::span<const PatchId> first,
                                 std::span<const PatchId> second, const EngineOptions& options);

/// `second` says of a patch of the island to which of the two maps it belongs; `matched` are those of
/// either that were found in the other.
SharedPart shared_part(const Map& map, std::span<const PatchId> island,
                       const std::function<bool(PatchId)>& second, std::span<const PatchId> matched,
                       const EngineOptions& options);

}  // namespace isthmus
