#pragma once

#include <vector>

#include "server/paths/roads/roadmap.hpp"

namespace isthmus {

/// A way pulled taut: each cell is seen from the one before, before and after. Ends stay.
std::vector<NodeId> pull(const Roadmap& roadmap, std::vector<NodeId> way);

/// In metres, along the surface.
double length_m(const Ground& ground, const std::vector<NodeId>& way);

}  // namespace isthmus
