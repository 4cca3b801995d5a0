#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/simulate/plan/floor_layout.hpp"

namespace isthmus {

/// Cupboards and tables along the walls of rooms and corridors, pillars and tables in halls; off the ways of
/// the robots and off the doors.
std::vector<std::vector<Eigen::Vector2d>> furnish(const FloorLayout& layout, const FloorStyle& style,
                                                  const std::vector<Segment>& ways);

}  // namespace isthmus
