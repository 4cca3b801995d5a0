#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/output/foxglove/messages.hpp"
#include "server/output/tables/islands.hpp"

namespace isthmus::foxglove {

/// An island and its frame.
struct Island {
  std::string frame;
  std::vector<PatchId> patches;
};

std::string island_frame(int number);

/// Of each island in frame "map": one beside the other from left to right, so that none covers another. They
/// stay where they are as they grow, until one needs ten metres more.
std::vector<Transform> side_by_side(const MapCopy& map, const std::vector<Island>& islands);

/// What is shown of each: patches, tags with their barcodes, and of each closure that is on the map a line
/// between two patches that it ties together.
std::vector<Scene> scenes(const MapCopy& map, const std::vector<Island>& islands);

/// What became of a closure, and how it is told.
std::string closure_text(const ClosureRecord& closure);
Level closure_level(const ClosureRecord& closure);

}  // namespace isthmus::foxglove
