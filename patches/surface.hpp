#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "patches/scan.hpp"

namespace isthmus {

/// A place between the ends of two neighbouring beams.
struct SurfacePoint {
  Eigen::Vector2d position;  ///< in the frame of the points
  std::size_t point = 0;     ///< index of the nearer end, on whose line it lies
};

/// Where a scan's beams end farther apart than `step_m`, but on one surface, it goes on between them: places
/// there, at most so far apart. `points` are a scan's, in order of beams. Far from the laser, or where a wall
/// runs away from it, most of a surface lies between beams. Two ends are on one surface where no beam between
/// them ends elsewhere and each lies on the line through the other.
std::vector<SurfacePoint> between_beams(std::span<const ScanPoint> points, double step_m);

}  // namespace isthmus
