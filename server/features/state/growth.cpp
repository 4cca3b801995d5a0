#include "server/features/state/growth.hpp"

#include <algorithm>

namespace isthmus {
namespace {

/// So weak a prior says nothing beside a measurement, and is far from the limits of doubles.
constexpr double no_prior_sigma = 10;

/// Moves an unknown end to where it was seen; false where that is not believed.
bool place_end(FeatureState& state, std::size_t index, std::size_t component, const Feature& seen,
               double slack_m) {
  const Feature& feature = state.features[index].feature;
  const double half = 0.5 * length_m(feature);
  const Eigen::Vector2d end = component == 2 ? seen.a : seen.b;
  const double at = along(feature).dot(end - 0.5 * (feature.a + feature.b));
  const double beyond = component == 2 ? -half - at : at - half;  // how far past what was seen of it
  if (beyond < -slack_m || beyond < -half) return false;
  stretch_segment(state, index, component == 2 ? at : -half, component == 2 ? half : at);
  return true;
}

}  // namespace

void learn_from(FeatureState& state, std::size_t index, const Feature& seen, double end_slack_m) {
  const std::array<bool, 4> observed = known_components(seen);
  for (std::size_t component = 2; component < 4; ++component) {
    Feature& feature = state.features[index].feature;
    if (!observed[component] || known_components(feature)[component]) continue;
    if (feature.kind == FeatureKind::segment && !place_end(state, index, component, seen, end_slack_m))
      continue;
    if (feature.kind == FeatureKind::pole) feature.radius_m = seen.radius_m;
    if (feature.kind == FeatureKind::corner) feature.b = feature.a + along(seen);
    make_known(state, index, component, no_prior_sigma);
  }
}

void reach_to(FeatureState& state, std::size_t index, const Feature& seen) {
  const Feature& feature = state.features[index].feature;
  if (feature.kind != FeatureKind::segment || (feature.end_a_known && feature.end_b_known)) return;
  const Eigen::Vector2d middle = 0.5 * (feature.a + feature.b), t = along(feature);
  const double half = 0.5 * length_m(feature);
  const double from = std::min(-half, t.dot(seen.a - middle)), to = std::max(half, t.dot(seen.b - middle));
  if (from < -half || to > half) stretch_segment(state, index, from, to);
}

}  // namespace isthmus
