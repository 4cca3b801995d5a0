#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tools/simulate/wild/draw.hpp"

namespace isthmus {

/// Bends a rectangle along its length: its middle line becomes straight pieces and arcs, and what lies across
/// it stays square to it. Along the inside of a bend lengths shrink by a fifth at most, so that ways that
/// keep clear of walls still do; across, nothing changes.
class Bend {
 public:
  Bend(const WildBuilding& building, const Eigen::Vector2d& size, std::uint64_t seed);

  Eigen::Vector2d operator()(const Eigen::Vector2d& point) const;
  /// A straight line, bent: its first point left out, points `spacing_m` apart at most.
  std::vector<Eigen::Vector2d> line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                    double spacing_m = 0.7) const;

 private:
  struct Arc {
    double from_x = 0, to_x = 0;
    double curvature_pm = 0;
  };
  std::vector<Arc> arcs_;  // in order of x, none over another
  double middle_y_ = 0;
};

}  // namespace isthmus
