#pragma once

#include <vector>

#include "tools/simulate/plan/floor_plan.hpp"

namespace isthmus {

/// Boxes strewn over a building's bounding box, the same ones in every run, off the ways of the robots.
struct Clutter {
  int count = 0;
  double size_min_m = 0.2;
  double size_max_m = 0.8;
  double clearance_m = 0.5;  ///< from every way
};

/// Polygons to add to the building's furniture. `ways` are legs that must stay clear. Fewer than asked for
/// where there is no room.
std::vector<std::vector<Eigen::Vector2d>> strew(const Clutter& clutter, const Building& building,
                                                const std::vector<Segment>& ways);

std::vector<Eigen::Vector2d> box(const Eigen::Vector2d& centre, double width_m, double depth_m,
                                 double yaw_rad);
std::vector<Eigen::Vector2d> disc(const Eigen::Vector2d& centre, double radius_m, int corners = 16);

}  // namespace isthmus
