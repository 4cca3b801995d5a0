#pragma once

#include <Eigen/Core>

#include "patches/pose.hpp"

namespace isthmus {

/// How a unicycle's odometry errs (Benedettelli et al. 2012, section 5.1): σ_v = v_share |v|, σ_ω =
/// turn_share |ω| + turn_floor, drawn anew each step.
struct UnicycleNoise {
  double v_share = 0.03;             ///< of the speed
  double turn_share = 0.05;          ///< of the turn rate
  double turn_floor_rad_s = 0.0017;  ///< rad/s
  double slip_share = 0;             ///< sideways, of the speed: none in the paper
};

/// One step of eqs. 27 to 29 as (x, y, yaw) in the robot's frame before it, with its covariance.
struct OdometryStep {
  Pose old_from_new;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};
OdometryStep unicycle_step(double v_m_s, double turn_rad_s, double step_s, const UnicycleNoise& noise);

}  // namespace isthmus
