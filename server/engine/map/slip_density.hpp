#pragma once

#include <cmath>
#include <numbers>

#include "patches/pose.hpp"
#include "server/engine/input/options/map_options.hpp"

namespace isthmus {

/// Log-density (per m² rad) of a wrong link's being off by so much, or of wheels that slipped: Cauchy's
/// distribution in the plane, and wrapped around the circle (Mardia and Jupp, 2000, "Directional statistics",
/// 3.5.7).
inline double log_slip_density(const Eigen::Vector3d& off, const WeakLinkOptions& its) {
  const double slip_rad = its.common.yaw_rad(its.slip_m);
  const double far = std::hypot(its.slip_m, off.x(), off.y());
  const double in_plane = its.slip_m / (2 * std::numbers::pi * far * far * far);
  const double of_yaw =
      std::sinh(slip_rad) / (2 * std::numbers::pi * (std::cosh(slip_rad) - std::cos(off.z())));
  return std::log(in_plane) + std::log(of_yaw);
}

}  // namespace isthmus
