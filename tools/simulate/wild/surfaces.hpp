#pragma once

#include <set>
#include <vector>

#include "tools/simulate/wild/bend.hpp"
#include "tools/simulate/wild/layout.hpp"

namespace isthmus {

/// What must stay clear.
struct WildUse {
  std::vector<Segment> ways;            ///< as planned, in the building before it is bent
  std::set<std::size_t> entered;        ///< cells
  std::vector<Eigen::Vector2d> driven;  ///< where robots and people come in truth, at most 0.1 m apart
};

/// The building as it is found at first, and after each of its changes: furniture has moved, and doors of
/// rooms that nobody enters are open or closed.
std::vector<FloorPlan> build_wild(const WildDraw& draw, const WildLayout& layout, const Bend& bend,
                                  const WildUse& use);

}  // namespace isthmus
