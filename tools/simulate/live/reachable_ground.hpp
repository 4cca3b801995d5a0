#pragma once

#include <vector>

#include "tools/simulate/run/ray_caster.hpp"

namespace isthmus {

/// Where in a building a robot's centre can come to: points of a lattice, over which it goes from a start
/// without coming nearer than a distance to anything.
class ReachableGround {
 public:
  static constexpr double spacing_m = 0.1;

  /// Within the bounding box of the plan.
  ReachableGround(const FloorPlan& plan, const RayCaster& caster, const Eigen::Vector2d& start,
                  double room_m);

  const std::vector<Eigen::Vector2d>& points() const { return points_; }
  double area_m2() const { return static_cast<double>(points_.size()) * spacing_m * spacing_m; }

 private:
  std::vector<Eigen::Vector2d> points_;
};

/// Places for so many robots beside one another, the first where it is asked, each in sight of it and with
/// room around it. Throws std::runtime_error where there are none.
std::vector<Eigen::Vector2d> starts_beside(const RayCaster& caster, const Eigen::Vector2d& first,
                                           std::size_t robots, double room_m);

}  // namespace isthmus
