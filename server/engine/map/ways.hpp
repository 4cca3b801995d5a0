#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "server/engine/map/map.hpp"

namespace isthmus {

/// Metres over relations, by the shortest way, from the nearest of some patches to every patch of the map, by
/// id; infinity where there is none, as on another island.
std::vector<double> ways_over_relations_m(const Map& map, std::span<const PatchId> from);

/// The same of a map that is asked many times: which patches are next to one another is found once.
class WayNetwork {
 public:
  explicit WayNetwork(const Map& map);

  std::vector<double> ways_m(std::span<const PatchId> from) const;

 private:
  struct Step {
    PatchId to;
    double length_m = 0;
  };
  std::vector<Step> steps_;         ///< from all patches, by id
  std::vector<std::size_t> first_;  ///< of each patch, and the end
};

}  // namespace isthmus
