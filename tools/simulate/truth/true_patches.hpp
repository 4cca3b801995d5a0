#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// Where a patch of a map truly is.
struct TruePatch {
  std::size_t robot = 0;    ///< index in the truth
  std::size_t stretch = 0;  ///< rises when the robot is carried
  Pose world_from_patch;
};

/// The true poses of patches by id; none where the robot is unknown or was somewhere else between its scans.
std::vector<std::optional<TruePatch>> true_patches(const MapCopy& map, const std::vector<RobotTruth>& truth);

}  // namespace isthmus
