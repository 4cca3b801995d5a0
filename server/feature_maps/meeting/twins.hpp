#pragma once

#include <cstddef>
#include <span>

#include "server/features/fusion/fusion.hpp"

namespace isthmus {

struct TwinOptions {
  std::size_t decoys = 12;  ///< other placings that the same two maps are tried at
  double reach_m = 6;       ///< m that they are off by, at most
};

/// How many twins the same two maps have where they do not belong together.
struct ByChance {
  double mean = 0;
  double spread = 1;  ///< variance over mean, at least 1: twins come in groups
};

ByChance twins_by_chance(const FeatureState& one, int robot_1, const FeatureState& two, int robot_2,
                         const RobotAlignment& alignment, const FusionOptions& fusion,
                         const TwinOptions& options);

/// How much so many twins speak for a placing: the log ratio of Poisson likelihoods with a mean of its own
/// against that by chance, divided by the spread, less what it costs to choose that mean. Fewer than by
/// chance speak against it.
double twins_log_odds(std::size_t twins, const ByChance& by_chance);

}  // namespace isthmus
