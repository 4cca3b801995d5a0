#pragma once

#include <Eigen/Core>
#include <vector>

#include "patches/scan.hpp"

namespace isthmus {

/// How a laser errs (Benedettelli et al. 2012, section 5.1: 3 mm and 3 mrad).
struct BeamNoise {
  double range_sigma_m = 0.01;      ///< m, of one range: what small time-of-flight lasers state
  double bearing_sigma_rad = 2e-3;  ///< rad, of one bearing: a quarter of a beam's width
  double surface_sigma_m = 0.005;   ///< m, along the beam: walls are not straight to the millimetre
};

/// The end of a beam, in the laser's frame.
struct BeamPoint {
  Eigen::Vector2d position;    ///< metres
  Eigen::Matrix2d covariance;  ///< m²: the noise of range along the beam, that of the bearing across it
  double range_m = 0;
  double bearing_rad = 0;
  int beam = 0;  ///< its number by rising bearing
};

/// The hits of a scan by rising bearing, whichever way the laser turns.
std::vector<BeamPoint> beam_points(const Scan& scan, const Laser& laser, const BeamNoise& noise);

}  // namespace isthmus
