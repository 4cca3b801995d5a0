#pragma once

#include <Eigen/Core>
#include <vector>

#include "patches/pose.hpp"
#include "tools/simulate/plan/floor_layout.hpp"

namespace isthmus {

struct FloorTour {
  Pose start;
  std::vector<Eigen::Vector2d> waypoints;
};

/// Tours of robots that start in different rooms, drive on the right of the corridors from room to room,
/// cross one another's ways at a few busy crossings, and gather by fours in a room at the end. `tour_m`:
/// about how far each drives; 0: as far as it takes to see most of the floor. Throws std::runtime_error where
/// there are fewer rooms with a door to a corridor than robots.
std::vector<FloorTour> plan_tours(const FloorLayout& layout, const FloorStyle& style, int robots,
                                  double tour_m);

}  // namespace isthmus
