#pragma once

#include "server/features/state/state.hpp"

namespace isthmus {

/// Makes known what another view of a feature (`seen`, in the map's frame) knows more of it: its ends,
/// heading or radius are placed as seen, with no covariance to speak of (10 m, rad), for the measurement to
/// follow. An end that lies short of where the wall was seen already, by more than `end_slack_m`, is not
/// believed.
void learn_from(FeatureState& state, std::size_t index, const Feature& seen, double end_slack_m);

/// Unknown ends of a segment move on to where it was seen.
void reach_to(FeatureState& state, std::size_t index, const Feature& seen);

}  // namespace isthmus
