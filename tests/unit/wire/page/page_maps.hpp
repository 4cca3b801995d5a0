#pragma once

#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "tests/support/relations.hpp"
#include "tests/support/walls.hpp"

namespace isthmus::testing {

/// Patches of a robot in the furnished room; those of one list make an island.
inline MapCopy map_of_islands(const std::vector<std::vector<Pose>>& islands) {
  MapCopy map;
  for (const std::vector<Pose>& poses : islands) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const PatchId id{static_cast<std::int32_t>(map.patches.size())};
      map.patches.push_back(patch_from(furnished_room(), id, poses[i]));
      map.poses.push_back(poses[i]);
      map.graph.add_patch(id);
      if (i > 0) map.graph.add(odometry_between(id.value - 1, id.value));
    }
  }
  return map;
}

}  // namespace isthmus::testing
