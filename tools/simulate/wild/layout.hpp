#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tools/simulate/plan/floor_layout.hpp"
#include "tools/simulate/wild/draw.hpp"

namespace isthmus {

/// A drawn building before it is bent: cells of corridors, rooms and yards that tile a rectangle.
struct WildLayout {
  FloorLayout floor;
  std::size_t first_yard = 0;  ///< cells from here on are yards: no door leads there
  /// Points on corridors' middle lines; driven in their order, and back to the first one, they are a lap. The
  /// first is the loop that was asked for.
  std::vector<std::vector<Eigen::Vector2d>> loops;

  bool is_yard(std::size_t cell) const { return cell >= first_yard; }
};

WildLayout lay_out_wild(const WildBuilding& building, std::uint64_t seed);

}  // namespace isthmus
