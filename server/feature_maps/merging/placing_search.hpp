#pragma once

#include "server/feature_maps/merging/map_sketch.hpp"

namespace isthmus {

/// Where two walls meet, or would. The turn from the first one's direction to the second one's is to the
/// left, so that a corner has one order of its walls, and gives a frame.
struct WallCorner {
  Eigen::Vector2d place;
  double heading_rad = 0;  ///< of the first wall
  double turn_rad = 0;     ///< from min_corner_rad to π less that
};

/// Those of the longest walls.
std::vector<WallCorner> corners_of(const MapSketch& sketch, const MergingOptions& options);

/// Where the second map may lie in the first: each pair of like corners votes for a placing, and those with
/// most votes come first. Bounded by max_corners² votes.
std::vector<Pose> propose_placings(const MapSketch& one, const MapSketch& two, const MergingOptions& options);

}  // namespace isthmus
