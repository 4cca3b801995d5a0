#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "patches/polysolid.hpp"
#include "tests/support/rectangle.hpp"

namespace isthmus::testing {

/// Ranges as a laser may send them that measures nothing.
inline constexpr float infinite_range = std::numeric_limits<float>::infinity();
inline constexpr float nan_range = std::numeric_limits<float>::quiet_NaN();

inline Polysolid solid(const Ring& outer, const std::vector<Ring>& holes = {}) {
  return Polysolid({PolygonWithHoles{outer, holes}});
}

/// A scan over [-90, 90] degrees, as FLASER's, with every beam at the same range.
inline Scan half_turn(std::size_t beams, float range_m) {
  Scan scan;
  scan.bearing0_rad = -0.5 * std::numbers::pi;
  scan.bearing_step_rad = std::numbers::pi / static_cast<double>(beams - 1);
  scan.ranges_m.assign(beams, range_m);
  return scan;
}

inline Scan full_turn(std::size_t beams, float range_m) {
  Scan scan;
  scan.bearing0_rad = -std::numbers::pi;
  scan.bearing_step_rad = 2 * std::numbers::pi / static_cast<double>(beams);
  scan.ranges_m.assign(beams, range_m);
  return scan;
}

inline double bearing_rad(const Scan& scan, std::size_t beam) {
  return scan.bearing0_rad + static_cast<double>(beam) * scan.bearing_step_rad;
}

/// The range along a bearing from the origin to the nearest of the half planes' borders: a convex room given
/// by the outward unit normals and distances of its walls.
struct HalfPlane {
  double normal_yaw_rad;
  double distance_m;
};

inline void look_at(Scan& scan, const std::vector<HalfPlane>& walls) {
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    double range_m = std::numeric_limits<double>::infinity();
    for (const HalfPlane& wall : walls) {
      const double towards = std::cos(bearing_rad(scan, i) - wall.normal_yaw_rad);
      if (towards > 1e-9) range_m = std::min(range_m, wall.distance_m / towards);
    }
    scan.ranges_m[i] = static_cast<float>(range_m);
  }
}

/// The same beams in the other order.
inline Scan reversed(const Scan& scan) {
  Scan other = scan;
  other.bearing0_rad = bearing_rad(scan, scan.ranges_m.size() - 1);
  other.bearing_step_rad = -scan.bearing_step_rad;
  other.ranges_m.assign(scan.ranges_m.rbegin(), scan.ranges_m.rend());
  return other;
}

}  // namespace isthmus::testing
