#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "isthmus/status_t.hpp"
#include "server/engine/record/map_copy.hpp"
#include "server/wire/page/map/robot_clocks.hpp"

namespace isthmus {

/// What the live server shows with each status.
struct LiveView {
  std::shared_ptr<const MapCopy> map;
  status_t status;
  double latency_p99_s = 0;  ///< of the engine's events
  bool frozen = false;
};

/// A map as viewers are shown it; never changed.
struct ShownMap {
  LiveView view;
  std::vector<IslandId> island_of;           ///< by patch id
  std::map<IslandId, std::int64_t> version;  ///< of each island's patches and relations
  std::map<IslandId, std::uint64_t> look;    ///< tells whether they are others
  RobotClocks clocks;
  std::int64_t first_utime =
      0;  ///< of the oldest patch that is no tag, by the server's clock; 0: there is none

  const MapCopy& map() const { return *view.map; }
  bool has(PatchId patch) const {
    return patch.valid() && static_cast<std::size_t>(patch.value) < island_of.size();
  }
  IslandId island(PatchId patch) const { return island_of[static_cast<std::size_t>(patch.value)]; }
  /// A manifold pose in the frame of its island.
  Pose project(const ManifoldPose& pose) const {
    return map().poses[static_cast<std::size_t>(pose.patch.value)] * pose.patch_from_object;
  }
};

/// Islands that look as before (their patches within a millimetre, and their relations) keep their version;
/// others get `version`.
ShownMap shown_map(LiveView view, const ShownMap* before, std::int64_t version);

/// Tenths of a second from the first patch of the map to a time of the server's clock, 0 at least.
std::int32_t tenths_after_first(const ShownMap& shown, std::int64_t utime);
/// When a patch was made; of tags 0.
std::int32_t tenths_of_patch(const ShownMap& shown, std::size_t patch);

/// The patches of an island and its relations, for drawing: little-endian arrays, one behind the other.
///
///     uint32  patches, relations, bytes of the names
///     char    names of robots, one a line, padded with spaces to whole fours
///     int32   id of each patch
///     int32   its robot, by line; -1: a fixed tag
///     float32 x, y of each patch in the island's frame, metres; then its yaw, radians: three arrays
///     int32   when each was made, tenths of a second after the first patch of the map
///     int32   places in the list of patches of each relation's ends: all a, then all b
///     int32   its origin: 0 odometry, 1 match, 2 sighting, 3 propagation, 4 hypothesis, 5 start
///     int32   the closure it came with; -1: none
///
/// Empty for an island that is not there.
std::string patch_arrays(const ShownMap& shown, IslandId island);

}  // namespace isthmus
