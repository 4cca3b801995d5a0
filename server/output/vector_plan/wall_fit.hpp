#pragma once

#include <span>
#include <vector>

#include "server/output/vector_plan/plan_options.hpp"
#include "server/output/vector_plan/plan_source.hpp"
#include "server/output/vector_plan/wall_line.hpp"

namespace isthmus {

/// A straight wall's line with the segments that it was fitted to.
struct FittedWall {
  WallLine line;
  std::vector<std::size_t> segments;  ///< indices, ascending
};

/// Lines through segments of one island: two are one wall where their difference (α, ρ) is within its
/// covariance, that of walls which are not quite straight added, and where they face the same side and no
/// more than a wide door lies between them. Segments join longest first; walls are joined until nothing
/// changes; then each segment goes to the wall that it agrees with best, and lines are fitted again. Longest
/// first. The faces of a wall are two walls. Cost: segments times the walls near each.
std::vector<FittedWall> fit_walls(std::span<const FeatureSeen> segments, const WallFitOptions& options);

}  // namespace isthmus
