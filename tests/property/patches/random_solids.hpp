#pragma once

#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "patches/polysolid.hpp"
#include "tests/property/drawn.hpp"
#include "tests/support/solids.hpp"

namespace isthmus::testing {

/// A scan as a laser might send it, hostile values included.
inline Scan any_scan(int max_beams = 120) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  Scan scan;
  const auto beams = static_cast<std::size_t>(*rc::gen::inRange(2, max_beams));
  const double turn = *rc::gen::element(0.5, 1.0, 1.5, 2.0) * std::numbers::pi;
  scan.bearing0_rad = between(-4, 4);
  scan.bearing_step_rad = turn / static_cast<double>(beams) * *rc::gen::element(-1, 1);
  const int bad_percent = *rc::gen::element(0, 0, 3, 40);
  double range_m = between(0.5, 8);
  for (std::size_t i = 0; i < beams; ++i) {
    // Smooth stretches with jumps, as of walls and corners.
    range_m = *rc::gen::inRange(0, 8) == 0 ? between(0.1, 12) : range_m + between(-0.1, 0.1);
    const bool bad = *rc::gen::inRange(0, 100) < bad_percent;
    scan.ranges_m.push_back(bad ? *rc::gen::element(inf, -inf, nan, 0.0F, -1.0F, 1e30F, 1e-30F)
                                : static_cast<float>(range_m));
  }
  return scan;
}

inline Laser any_laser() {
  Laser laser;
  laser.robot_from_laser = any_pose(0.5);
  return laser;
}

inline Polysolid any_free_space() {
  FreeSpaceOptions options;
  options.no_return_range_m = *rc::gen::element(0.0, 2.0);
  options.outline.simplify_tolerance_m = *rc::gen::element(0.0, 0.03, 0.2);
  return transformed(any_pose(8), free_space_of(any_scan(40), any_laser(), options));
}

/// Points thrown down at random: it crosses itself, and on the coarse lattice repeats and touches itself.
inline Ring garbage_ring() {
  Ring ring;
  const bool lattice = *rc::gen::inRange(0, 2) == 0;
  const int points = *rc::gen::inRange(0, 14);
  for (int i = 0; i < points; ++i) {
    Eigen::Vector2d point(between(0, 4), between(0, 4));
    ring.push_back(lattice ? Eigen::Vector2d(point.array().round()) : point);
  }
  return ring;
}

/// Any polysolid: free space, garbage repaired, or two free spaces joined.
inline Polysolid any_solid() {
  switch (*rc::gen::inRange(0, 4)) {
    case 0:
      return transformed(any_pose(3), Polysolid({{garbage_ring(), {garbage_ring()}}, {garbage_ring(), {}}}));
    case 1:
      return united({any_free_space(), any_free_space()});
    default:
      return any_free_space();
  }
}

inline double distance_to_boundary(const Polysolid& solid, const Eigen::Vector2d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  const auto look = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d& a = ring[i];
      const Eigen::Vector2d along = ring[(i + 1) % ring.size()] - a;
      const double t = std::clamp((point - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
      nearest = std::min(nearest, (point - a - t * along).norm());
    }
  };
  for (const PolygonWithHoles& polygon : solid.polygons()) {
    look(polygon.outer);
    for (const Ring& hole : polygon.holes) look(hole);
  }
  return nearest;
}

}  // namespace isthmus::testing
