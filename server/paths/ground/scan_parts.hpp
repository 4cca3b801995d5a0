#pragma once

#include <vector>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// The parts of a map that scans and odometry hold together, however many patches lie between: by patch, the
/// lowest id of its part. How parts lie to one another is known by sightings, tags or given poses alone: to
/// some centimetres and degrees, too coarsely for the walls of the one to lie on those of the other.
std::vector<PatchId> scan_parts(const MapCopy& map);

}  // namespace isthmus
