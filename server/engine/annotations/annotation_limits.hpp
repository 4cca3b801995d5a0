#pragma once

#include <cstddef>

namespace isthmus {

/// Bounds of what operators may write on a map. They decide nothing about its shape.
struct AnnotationLimits {
  std::size_t annotations = 256;  ///< places and zones of a map
  std::size_t corners = 64;       ///< of a zone
  double from_patch_m = 50;       ///< from a point to the nearest patch: farther out nothing holds it
  double min_area_m2 = 0.01;      ///< of a zone
  double max_speed_m_s = 100;
  /// Points of one annotation hold on to patches that are near one another along relations, or the closing of
  /// a loop would tear it: no farther than `way_share` times as the crow flies, and `way_m`.
  double way_share = 3;
  double way_m = 10;
};

}  // namespace isthmus
