#pragma once

#include <optional>
#include <tuple>

#include "server/features/state/correction.hpp"

namespace isthmus {

/// A feature of the state as a robot saw it: x_p of both in the frame of what was seen, so that neither has a
/// lever arm. Only what both know is compared; without `all_components` only the first two (the line of a
/// segment, the place of others). Derivatives are g'Rᵀ(e_l − e_p − J(l − p) e_θ) for each of its points l
/// seen from p. Nothing where the kinds differ, or the two face opposite sides (a thin wall has two).
std::optional<LinearMeasurement> measure_feature(const FeatureState& state, std::size_t index, int robot,
                                                 const ObservedFeature& seen, bool all_components = true);

/// One robot's pose in another's frame, or part of it, measured with a covariance.
struct RelativeSighting {
  int observer = 0;
  int target = 0;
  double range_m = 0;
  double bearing_rad = 0;
  double range_sigma_m = 1;
  double bearing_sigma_rad = 1;

  auto members() {
    return std::tie(observer, target, range_m, bearing_rad, range_sigma_m, bearing_sigma_rad);
  }
};
/// Range and bearing from a robot's origin to another's; a σ of infinity: that part was not measured. Nothing
/// where they stand at one place, a σ is not positive, or neither was measured.
std::optional<LinearMeasurement> measure_robot(const FeatureState& state, const RelativeSighting& sighting);
/// The same of a feature's point; the target is not looked at.
std::optional<LinearMeasurement> measure_point(const FeatureState& state, std::size_t index,
                                               const RelativeSighting& sighting);

/// Where one robot is as seen from another, (x, y, yaw) with its covariance.
LinearMeasurement measure_relative_pose(const FeatureState& state, int one, int two, const Pose& one_from_two,
                                        const Eigen::Matrix3d& covariance);

/// Two features of the state are one (Zhou and Roumeliotis 2006, eq. 20): the implicit measurement that what
/// both know of x_p does not differ; as exact as `sigma_m` (m, rad).
std::optional<LinearMeasurement> measure_identity(const FeatureState& state, std::size_t one,
                                                  std::size_t other, double sigma_m);

}  // namespace isthmus
