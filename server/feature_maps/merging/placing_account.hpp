#pragma once

#include <cstdint>
#include <vector>

#include "server/feature_maps/merging/map_sketch.hpp"

namespace isthmus {

/// Two walls that may be one.
struct WallTwin {
  std::size_t one = 0;  ///< indices into the sketches
  std::size_t two = 0;
  double off_m = 0;  ///< between their lines
};

/// What two maps say of one placing of the second in the first.
struct PlacingAccount {
  Pose one_from_two;
  std::vector<WallTwin> twins;   ///< by index of the second map's
  std::size_t explained = 0;     ///< walls of either map with a twin, the smaller number
  double contradicted = 0;       ///< walls of either map that would stand where the other one saw through,
                                 ///< beyond the share that stand where their own map did
  std::size_t beyond = 0;        ///< walls that the other map has not been near, of that map which has fewer
  std::size_t across = 0;        ///< of `explained`, those of the direction that has fewer
  std::vector<WallFate> of_two;  ///< what becomes of each wall of the second map
};

/// With walls that differ by no more than `within_m`.
std::vector<WallTwin> twins_at(const MapSketch& one, const MapSketch& two, const Pose& one_from_two,
                               double within_m, const MergingOptions& options);

/// The placing at which the walls that are twins about there lie best (least squares of the distances
/// between their lines, with a robust loss).
Pose refined_placing(const MapSketch& one, const MapSketch& two, const Pose& start,
                     const MergingOptions& options);

PlacingAccount account_of(const MapSketch& one, const MapSketch& two, const Pose& one_from_two,
                          const MergingOptions& options);

/// Whether two placings are the same: by where the second map's middle lies, and its heading. `times` the
/// bounds of the options.
bool is_same_placing(const Pose& a, const Pose& b, const Eigen::Vector2d& middle,
                     const MergingOptions& options, double times = 1);

}  // namespace isthmus
