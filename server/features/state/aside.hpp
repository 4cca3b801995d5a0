#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "server/features/state/state.hpp"

namespace isthmus {

/// Features that no robot sees now. Their errors, given those that the rest of the state had when they were
/// set aside, are independent of all that is measured of the rest; so what is measured is kept for them as
/// what it tells of those errors, and they are corrected all at once when they are taken back: the compressed
/// filter (Guivant and Nebot, IEEE Transactions on Robotics and Automation 17(3), 2001). To the second order
/// of turns it is what correcting them each time gives.
struct FeaturesAside {
  std::vector<FeatureInState> features;  ///< as they were then, by id; offsets are those in `covariance`
  Eigen::MatrixXd covariance;            ///< of their errors then
  Eigen::MatrixXd with_rest;             ///< of their errors with those of the rest, then
};

/// Whether they are what was set aside of that state.
bool is_sound(const FeaturesAside& aside, const FeatureState& rest);

/// Sets all features aside but for those of `kept`, ascending indices. What is left begins with errors of a
/// second kind (FeatureState::told), which no function of a state touches but for corrections.
FeaturesAside set_aside(FeatureState& state, std::span<const std::size_t> kept);

/// The state is whole again.
void take_back(FeatureState& state, const FeaturesAside& aside);

/// They as they are now.
std::vector<FeatureInState> estimates(const FeaturesAside& aside, const FeatureState& rest);

/// A robot of the rest with one of them: a state of these two, its covariance at least what it is.
FeatureState robot_with(const FeaturesAside& aside, std::size_t index, const FeatureState& rest, int robot,
                        const Feature& as_it_is);

void remove_feature(FeaturesAside& aside, std::size_t index);

}  // namespace isthmus
