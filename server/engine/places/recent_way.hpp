#pragma once

#include <deque>
#include <tuple>

#include "patches/ids.hpp"

namespace isthmus {

/// The last metres of a robot's way, by its patches.
struct RecentWay {
  std::deque<PatchId> newest_first;
  std::deque<double> from_newest_m;  ///< along the way

  /// The robot has a new patch, so far from the one before; what is farther back than `max_m` is left out.
  void add(PatchId patch, double step_m, double max_m);
  double length_m() const { return from_newest_m.empty() ? 0 : from_newest_m.back(); }

  auto members() { return std::tie(newest_first, from_newest_m); }
};

}  // namespace isthmus
