#pragma once

#include <cstddef>

#include "patches/option_unit.hpp"

namespace isthmus {

/// The last pass over a log (isthmus-replay --refine), see record/refinement.hpp.
struct RefinementOptions {
  std::size_t max_patches = 12;
  double min_score = 0.35;
  double start_kernel_m = 0.08;
  double carried_sigma_m = 0.05;
  double carried_sigma_rad = 0.02;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(max_patches, "max_patches", "count",
           "of a local map: the nearest, as none is newer than another here");
    option(min_score, "min_score", share_unit, "of a match that is taken over");
    option(start_kernel_m, "start_kernel_m", "m",
           "match.start_kernel_m of these: the scan lies nearly right");
    option(carried_sigma_m, "carried_sigma_m", "m",
           "standard deviation of a scan from where its patch has carried it");
    option(carried_sigma_rad, "carried_sigma_rad", "rad", "the same of its yaw");
  }
};

}  // namespace isthmus
