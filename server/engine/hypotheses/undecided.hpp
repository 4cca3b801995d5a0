#pragma once

#include <tuple>

#include "patches/ids.hpp"
#include "patches/pose.hpp"

namespace isthmus {

/// A hypothesis from scans that nothing has decided yet: how two patches lie to one another, were it true.
struct UndecidedHypothesis {
  ClosureId id;
  PatchId first;  ///< of the older island
  PatchId second;
  Pose first_from_second;
  /// What deciding it would be worth: patches that would come to be joined, times its likelihood.
  double value = 0;

  auto members() { return std::tie(id, first, second, first_from_second, value); }
};

}  // namespace isthmus
