#pragma once

#include <cstdint>
#include <set>

#include "server/feature_maps/feature_estimator.hpp"
#include "tests/support/feature_events.hpp"

namespace isthmus::testing {

/// What comes of a whole run by segments, without the fusions that are forbidden.
inline FeatureEstimator estimate(const FeatureEvents& run, const std::set<std::int32_t>& forbidden = {}) {
  FeatureEstimator estimator(feature_map_options(FeatureMapKind::segments));
  estimator.forbid(forbidden);
  for (const Event& event : run.events) estimator.handle(event);
  Outcome outcome;
  estimator.finish_step(outcome);
  return estimator;
}

}  // namespace isthmus::testing
