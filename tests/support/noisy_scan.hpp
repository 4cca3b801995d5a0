#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/walls.hpp"

namespace isthmus::testing {

/// A full turn's share of beams, seen from a pose among walls, whose ranges and bearings err.
struct NoisyLaser {
  int beams = 181;
  double view_rad = std::numbers::pi;
  double range_max_m = 20;
  double range_sigma_m = 0;
  double bearing_sigma_rad = 0;

  Laser laser() const { return laser_of(range_max_m); }

  Scan scan(const Walls& walls, const Pose& world_from_robot, std::mt19937& random) const {
    std::normal_distribution<double> normal;
    Scan scan;
    scan.bearing0_rad = -0.5 * view_rad;
    scan.bearing_step_rad = view_rad / (beams - 1);
    for (int i = 0; i < beams; ++i) {
      const double bearing = world_from_robot.yaw + scan.bearing0_rad + i * scan.bearing_step_rad;
      const double range = range_to(walls, {world_from_robot.x, world_from_robot.y},
                                    bearing + bearing_sigma_rad * normal(random)) +
                           range_sigma_m * normal(random);
      scan.ranges_m.push_back(static_cast<float>(std::min(range, range_max_m)));
    }
    return scan;
  }
};

/// A regular polygon of 36 sides: to a laser, a round pillar.
inline void add_pillar(Walls& walls, const Eigen::Vector2d& centre, double radius_m) {
  constexpr int sides = 36;
  const auto corner = [&](int i) -> Eigen::Vector2d {
    const double at = 2 * std::numbers::pi * i / sides;
    return centre + radius_m * Eigen::Vector2d(std::cos(at), std::sin(at));
  };
  for (int i = 0; i < sides; ++i) walls.push_back({corner(i), corner(i + 1)});
}

}  // namespace isthmus::testing
