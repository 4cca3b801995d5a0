#pragma once

#include "server/features/state/state.hpp"
#include "server/output/vector_plan/plan_source.hpp"

namespace isthmus {

/// Segments and poles of a feature map as what a floor plan is made of: each as if seen in one view, with
/// its covariance. There are no beams; openings are between ends that are known.
PlanSource plan_source(const FeatureState& state);

}  // namespace isthmus
