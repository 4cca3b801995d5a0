#pragma once

#include "server/features/state/state.hpp"

namespace isthmus {

/// Moves poses and features by the correction `delta` of all errors e, in the form of the state. The
/// covariance is of errors at the old estimate; the printed form leaves it so, the invariant one carries it
/// over: what is not observable (where the map lies and how it is turned) is then the same subspace before
/// and after, whatever the correction, and no information about it can be gained (Barrau and Bonnabel,
/// sections III and IV).
void apply_correction(FeatureState& state, const Eigen::VectorXd& delta);

/// The same of features alone, whose errors begin at `first`, by corrections of before: `delta` is of those
/// errors, and robots turned by RobotInState::turned_rad meanwhile.
void apply_delayed_correction(FeatureState& state, int first, const Eigen::VectorXd& delta);
/// Where it puts one of them.
Feature delayed_estimate(const FeatureState& state, const FeatureInState& entry, const LocalVector& delta);

/// The same left motion of all poses and features, about the map's origin; covariances turn with it.
void move_map(FeatureState& state, const Pose& new_from_old);

}  // namespace isthmus
