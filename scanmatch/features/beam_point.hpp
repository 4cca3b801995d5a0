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
  double surface_reach_m = 0.5;     ///< m along a wall over which it is off by the same: beams nearer to one
                                    ///< another than that err alike
};

/// The end of a beam, in the laser's frame.
struct BeamPoint {
  Eigen::Vector2d position;    ///< metres
  Eigen::Matrix2d covariance;  ///< m²: the noise of range along the beam, that of the bearing across it
  double range_m = 0;
  double bearing_rad = 0;
  int beam = 0;                 ///< its number by rising bearing
  double surface_variance = 0;  ///< m² along the beam: what of the covariance is the wall's own
  double surface_reach_m = 0;   ///< m over which that is the same for points of one wall
};

/// The hits of a scan by rising bearing, whichever way the laser turns.
std::vector<BeamPoint> beam_points(const Scan& scan, const Laser& laser, const BeamNoise& noise);

}  // namespace isthmus
