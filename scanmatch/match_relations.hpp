#pragma once

#include <span>
#include <vector>

#include "relations/relation.hpp"
#include "scanmatch/match.hpp"

namespace isthmus {

struct MatchRelationOptions {
  /// Beams of one scan err together (the laser's mount, its timing, what stands in the way), so the noise of
  /// one correspondence is taken as this many times the match's RMS distance, and at least of so many metres.
  double sigma_per_rms = 4;
  double least_rms_m = 0.004;
  int min_correspondences = 10;  ///< patches paired with fewer beams get no relation
  double robust_scale = 0;       ///< of the loss on the pair as a whole; 0: none
};

/// The noise of one correspondence of a match, in metres, calibrated by `options`.
double relation_sigma_m(const MatchQuality& quality, const MatchRelationOptions& options);

/// The relations that a match found (Howard et al. 2006, IV-A, step 3): for each patch of the local map that
/// enough beams were paired with, the pairs as points of the new patch on lines of that patch. Ids are still
/// to be given.
std::vector<Relation> match_relations(const LocalMap& local_map, std::span<const ScanPoint> points,
                                      const Match& match, PatchId new_patch, const Origin& origin,
                                      const MatchRelationOptions& options = {});

}  // namespace isthmus
