#pragma once

#include <span>
#include <string>

#include "relations/graph.hpp"

namespace isthmus {

/// How well patch b is determined with respect to patch a, to read: the relative pose, its standard
/// deviations and covariance in a's frame (exact, over the whole island). Throws std::runtime_error where
/// there is no such patch, the two are on different islands, or the relations leave the island undetermined.
std::string confidence_text(const RelationGraph& graph, std::span<const Pose> poses, PatchId a, PatchId b);

}  // namespace isthmus
