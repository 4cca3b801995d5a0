#pragma once

#include <vector>

#include "server/output/vector_plan/plan_options.hpp"
#include "server/output/vector_plan/plan_poles.hpp"
#include "server/output/vector_plan/plan_source.hpp"

namespace isthmus {

/// One face of a wall, or of whatever is straight: a segment whose observer has a on the right and b on the
/// left. A wall seen from both sides is two of them.
struct PlanWall {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  double sigma_m = 0;  ///< of its middle across it, relative to the patches around
  int views = 0;       ///< that saw some of it
};

/// A gap of a door's width between two walls on one line, that was looked through.
struct PlanOpening {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
};

/// A floor plan in straight lines and circles, metres, frame of the island.
struct VectorPlan {
  std::vector<PlanWall> walls;  ///< longest lines first, along each in order
  std::vector<PlanOpening> openings;
  std::vector<PlanPole> poles;
};

/// Fits lines to all segments jointly (`fit_walls`), tells what of each is wall (`stretches_of`), and brings
/// walls that nearly meet to where they do.
VectorPlan fit_plan(const PlanSource& source, const PlanOptions& options);

}  // namespace isthmus
