#pragma once

#include <deque>
#include <span>
#include <tuple>
#include <vector>

#include "patches/ids.hpp"
#include "patches/manifold.hpp"
#include "server/engine/input/options/hypothesis_options.hpp"

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

/// The pieces of a robot's way that are searched for while it drives, each newest first: by its patches,
/// which are on one island, in the order in which they were made.
std::vector<std::vector<PatchId>> pieces_along(const Manifold& manifold, std::span<const PatchId> patches,
                                               const HypothesisOptions& options);

}  // namespace isthmus
