#pragma once

#include <string_view>
#include <vector>

#include "patches/manifold.hpp"

namespace isthmus {

/// Why a question has no answer; none: it has one.
enum class Refusal {
  none,
  bad_value,      ///< something is not finite, negative or too large
  unknown_patch,  ///< it is not on the map, or was left out of it
  unknown_robot,  ///< no such robot is on the map
  unknown_tag,    ///< no such tag is placed
  unknown_place,  ///< no place has that name, or none of its patches is on the map
  other_island,   ///< how the two islands lie is not known
  no_ground,      ///< nothing is known of the ground there
  kept_out,       ///< the start or the target is in a keep-out zone, or the only way leads through one
  no_room,        ///< the footprint fits nowhere near there
  unreachable,    ///< there is no way over known ground
  too_long,       ///< none was found within the steps that a question may take
  undetermined,   ///< the map's relations do not tell how the two lie
};

/// A word of lower case letters and underscores, the same in every release.
std::string_view word(Refusal refusal);

/// A chain of patches with poses in them: the robot's centre goes straight from each to the next.
struct Path {
  Refusal refusal = Refusal::none;
  std::vector<ManifoldPose> poses;  ///< each but the first faces where one comes from the one before
  double length_m = 0;
  /// By pose, m/s: of the slowest speed zone that the robot comes into on the way to it; 0: it comes into
  /// none.
  std::vector<double> max_speeds_m_s;
};

}  // namespace isthmus
