#pragma once

#include <memory>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/wire/page/map/shown_map.hpp"
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

/// As a page shows a map that is nothing but this.
inline ShownMap shown_of(const MapCopy& map) {
  return shown_map({std::make_shared<const MapCopy>(map), {}, 0, false}, nullptr, 1);
}

}  // namespace isthmus::testing
