#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "patches/patch.hpp"

namespace isthmus::testing {

using Wall2d = std::pair<Eigen::Vector2d, Eigen::Vector2d>;
using Walls = std::vector<Wall2d>;

inline void add_box(Walls& walls, double x0, double y0, double x1, double y1) {
  const Eigen::Vector2d a(x0, y0), b(x1, y0), c(x1, y1), d(x0, y1);
  walls.insert(walls.end(), {{a, b}, {b, c}, {c, d}, {d, a}});
}

/// A square room about the origin, with nothing in it.
inline Walls box(double half_m) {
  Walls walls;
  add_box(walls, -half_m, -half_m, half_m, half_m);
  return walls;
}

/// A room of 8 m by 6 m with a cupboard in a corner and a pillar, so that no two views of it are alike.
inline Walls furnished_room() {
  Walls walls;
  add_box(walls, -4, -3, 4, 3);
  add_box(walls, 2.5, 1.8, 4, 3);
  add_box(walls, -2.2, 0.9, -1.8, 1.3);
  return walls;
}

/// That room with a closet and a recess: it looks like itself in one pose only.
inline Walls crooked_room() {
  Walls walls = furnished_room();
  add_box(walls, -4, 1.2, -2.8, 3);
  add_box(walls, 0, -3, 1.5, -2.4);
  add_box(walls, 3.2, -1.5, 4, 0.5);
  return walls;
}

/// Two parallel walls, 2 m apart, longer than any laser sees.
inline Walls corridor() { return {{{-100, -1}, {100, -1}}, {{-100, 1}, {100, 1}}}; }

/// As a laser that errs by so much at random would have ranged it.
template <class Engine>
Scan with_noise(Scan scan, double sigma_m, Engine& engine) {
  std::normal_distribution<float> off_m(0, static_cast<float>(sigma_m));
  for (float& range_m : scan.ranges_m) range_m += off_m(engine);
  return scan;
}

/// A hall of 4 m by 27 m along x, with niches no two of which are alike.
inline Walls niched_hall() {
  Walls walls;
  add_box(walls, -3, -2, 24, 2);
  double x = -2;
  double side = 1;
  for (const double width : {0.4, 1.1, 0.6, 0.9, 0.3, 0.7, 1.2, 0.5, 0.8}) {
    add_box(walls, x, side * 2 - 0.5, x + width, side * 2 + 0.5);
    x += 1.8 + width;
    side = -side;
  }
  return walls;
}

/// From an eye along a bearing to the nearest wall; infinite where there is none.
double range_to(const Walls& walls, const Eigen::Vector2d& eye, double bearing);

/// A scan of 180 beams over half a turn, from a pose among the walls, with beams cut at range_max_m.
Scan scan_from(const Walls& walls, const Pose& world_from_robot, std::int64_t utime = 0,
               double range_max_m = 20, int beams = 180);

inline Laser laser_of(double range_max_m = 20) { return {{}, 0.05, range_max_m}; }

inline PatchPtr patch_from(const Walls& walls, PatchId id, const Pose& world_from_robot) {
  return make_patch(id, "R1", scan_from(walls, world_from_robot), laser_of(), {});
}

}  // namespace isthmus::testing
