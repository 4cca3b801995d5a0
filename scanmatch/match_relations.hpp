#pragma once

#include <span>
#include <vector>

#include "patches/option_unit.hpp"
#include "relations/relation.hpp"
#include "scanmatch/match.hpp"

namespace isthmus {

struct MatchRelationOptions {
  double sigma_per_rms = 4;
  double min_rms_m = 0.004;
  int min_correspondences = 10;
  double min_weight = 1e-3;
  double min_trust = 1e-3;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(sigma_per_rms, "sigma_per_rms", "factor",
           "noise of one correspondence as a multiple of the match's RMS distance: beams of one scan err "
           "together (the laser's mount, its timing, what stands in the way)");
    option(min_rms_m, "min_rms_m", "m", "smaller RMS distances count as this");
    option(min_correspondences, "min_correspondences", "count",
           "of a patch with the scan; with fewer it gets no relation");
    option(min_weight, "min_weight", share_unit, "robust weight below which a pair is left out");
    option(min_trust, "min_trust", share_unit, "trust in its direction below which a pair is left out");
  }
};

/// The noise of one correspondence of a match, in metres, calibrated by `options`.
double relation_sigma_m(const MatchQuality& quality, const MatchRelationOptions& options);

/// The relations that a match found (Howard et al. 2006, IV-A, step 3): for each patch of the local map that
/// enough beams were paired with, the pairs as points of the new patch on lines of that patch. Ids are still
/// to be given.
std::vector<Relation> match_relations(const LocalMap& local_map, std::span<const ScanPoint> points,
                                      const Match& match, PatchId new_patch, const Origin& origin,
                                      const MatchRelationOptions& options);

}  // namespace isthmus
