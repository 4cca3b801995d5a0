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

/// Of an island of R1's with its session: a row of its trajectory on each patch, a second apart.
inline MapCopy map_of_a_drive(const std::vector<Pose>& poses) {
  MapCopy map = map_of_islands({poses});
  const auto trajectory = std::make_shared<TrajectoryStore>();
  for (std::size_t i = 0; i < poses.size(); ++i)
    trajectory->append(
        {1'000'000 * static_cast<std::int64_t>(i + 1), 0, PatchId{static_cast<std::int32_t>(i)}, Pose{}});
  trajectory->flush();
  map.sessions = {{"R1", 0, 1'000'000, 1'000'000 * static_cast<std::int64_t>(poses.size()), PatchId{0}}};
  map.trajectory_rows = trajectory->size();
  map.trajectory = trajectory;
  return map;
}

/// As a page shows a map that is nothing but this.
inline ShownMap shown_of(const MapCopy& map) {
  return shown_map({std::make_shared<const MapCopy>(map), {}, 0, false}, nullptr, 1);
}

}  // namespace isthmus::testing
