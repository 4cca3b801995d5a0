#pragma once

namespace isthmus {

/// The last pass over a log (isthmus-replay --refine), see record/refinement.hpp.
struct RefinementOptions {
  double carried_sigma_m = 0.05;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(carried_sigma_m, "carried_sigma_m", "m",
           "standard deviation of a scan from where its patch has carried it");
  }
};

}  // namespace isthmus
