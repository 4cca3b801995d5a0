#include "server/feature_maps/output/feature_source.hpp"

namespace isthmus {

PlanSource plan_source(const FeatureState& state) {
  PlanSource source;
  for (std::size_t i = 0; i < state.features.size(); ++i) {
    const Feature& feature = state.features[i].feature;
    const FeatureSeen seen{{feature, feature_covariance(state, i)}, static_cast<int>(i)};
    if (feature.kind == FeatureKind::segment) source.segments.push_back(seen);
    if (feature.kind == FeatureKind::pole) source.poles.push_back(seen);
  }
  return source;
}

}  // namespace isthmus
