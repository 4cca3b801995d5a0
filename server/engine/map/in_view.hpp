#pragma once

#include <span>

#include "scanmatch/local_map.hpp"
#include "server/engine/input/options/map_options.hpp"

namespace isthmus {

/// What a part of the map says of points: most of what a scan sees may lie where it never looked.
struct InView {
  int seen = 0;            ///< near a point of its own
  int looked_through = 0;  ///< deep in its free space
  int out_of_view = 0;     ///< behind what it saw, or where it did not look

  /// Of all points, the share that it had in view; 0 of none.
  double share() const;
  /// Of those in view, the share that it saw; 0 of none.
  double share_seen() const;
};

InView in_view(const LocalMap& local, std::span<const ScanPoint> points, const Pose& local_from_points,
               const ContradictionOptions& options);

}  // namespace isthmus
