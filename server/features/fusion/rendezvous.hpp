#pragma once

#include "server/features/state/state.hpp"

namespace isthmus {

/// Two robots that see one another (Zhou and Roumeliotis 2006, III-A; Benedettelli et al. 2012, 4.1).
/// Bearings are in the observer's frame.
struct MutualSighting {
  double range_1_m = 0;  ///< of robot 2, as robot 1 measures it
  double range_2_m = 0;
  double bearing_1_rad = 0;  ///< ¹θ₂: of robot 2, as robot 1 sees it
  double bearing_2_rad = 0;
  double range_1_sigma_m = 1;
  double range_2_sigma_m = 1;
  double bearing_1_sigma_rad = 1;
  double bearing_2_sigma_rad = 1;
};

/// Where robot 2 is as seen from robot 1, in closed form, and how (x, y, yaw) err.
struct RobotAlignment {
  Pose one_from_two;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  bool is_polar = false;  ///< what errs are a range and bearings, so that where robot 2 may be is an arc

  auto members() { return std::tie(one_from_two, covariance, is_polar); }
};

/// The ranges' weighted mean, θ = π + ¹θ₂ − ²θ₁, and robot 2 at that range and bearing (Zhou and Roumeliotis
/// 2006, eqs. 1 to 5; Benedettelli et al. 2012, eqs. 14 and 15). Throws std::invalid_argument where a σ or a
/// range is not positive.
RobotAlignment align_robots(const MutualSighting& sighting);

/// Both states in the frame of the first (eqs. 6 to 13 and 16), with the covariance of all: errors of the
/// first state stay; those of the second become
///
///     e₂' = B'(rigid₁ e_r₁ + R₁ rigid_A e_A + R (B̃ e₂ − rigid₂ e_r₂))
///
/// r₁ and r₂ the robots that met, A their alignment, R the turn of the second map: eqs. 14 to 19 of Zhou and
/// Roumeliotis 2006 and the three steps of eqs. 17 to 26 of Benedettelli et al. 2012 in one, at a cost of n².
/// Robots and features of the second follow those of the first in their order; their ids begin at the first's
/// next_id.
FeatureState aligned(const FeatureState& one, int robot_1, const FeatureState& two, int robot_2,
                     const RobotAlignment& alignment);

}  // namespace isthmus
