#include "server/features/unicycle_noise.hpp"

#include <cmath>

namespace isthmus {

OdometryStep unicycle_step(double v_m_s, double turn_rad_s, double step_s, const UnicycleNoise& noise) {
  OdometryStep step;
  step.old_from_new = {v_m_s * step_s, 0, wrap_angle(turn_rad_s * step_s)};
  const double turn_sigma = noise.turn_share * std::abs(turn_rad_s) + noise.turn_floor_rad_s;
  step.covariance.diagonal() << std::pow(noise.v_share * v_m_s * step_s, 2),
      std::pow(noise.slip_share * v_m_s * step_s, 2), std::pow(turn_sigma * step_s, 2);
  return step;
}

}  // namespace isthmus
