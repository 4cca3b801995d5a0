#pragma once

#include <Eigen/Core>
#include <set>
#include <vector>

#include "tools/simulate/wild/bend.hpp"
#include "tools/simulate/wild/layout.hpp"

namespace isthmus {

/// Where somebody drives: as steps in the bent building, and as straight lines before it is bent.
struct WildTourPlan {
  Pose start;
  std::vector<TourStep> steps;
  std::vector<Segment> ways;
  std::set<std::size_t> rooms;  ///< cells that are entered
};

/// Tours of the robots, then of the people, who walk the same loops until the robots are done. Each begins in
/// a corridor on its loop, drives its laps, enters rooms on the way and turns on the spot, and after its last
/// lap goes on where it has been before.
std::vector<WildTourPlan> plan_wild_tours(const WildDraw& draw, const WildLayout& layout, const Bend& bend);

}  // namespace isthmus
