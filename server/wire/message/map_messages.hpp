#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "isthmus/grid_t.hpp"
#include "isthmus/map_t.hpp"
#include "server/engine/record/map_copy.hpp"
#include "server/output/grid/grid.hpp"

namespace isthmus {

/// Writes a map as ISTHMUS_MAP messages, each small enough for one UDP datagram (unless a single patch is
/// larger). It remembers what it wrote last, so that only changes need to be sent.
class MapMessages {
 public:
  /// A patch that moved by less than this since it was sent is not sent again.
  static constexpr double still_m = 1e-3;
  static constexpr double still_rad = 1e-3;

  /// Every patch with its free space, and every relation; never empty.
  std::vector<map_t> whole(const MapCopy& map, std::int64_t utime);

  /// New patches with their free space; patches that moved or changed island without it; new and changed
  /// relations; removed ones. Empty where nothing changed.
  std::vector<map_t> changes(const MapCopy& map, std::int64_t utime);

 private:
  struct SentPatch {
    Pose pose;
    IslandId island;
  };

  std::vector<SentPatch> patches_;             ///< by patch id
  std::map<RelationId, int> relation_counts_;  ///< of the relations sent
};

grid_t grid_message(const OccupancyGrid& grid, IslandId island, std::int64_t utime);

}  // namespace isthmus
