#pragma once

#include <span>

#include "relations/block_cholesky.hpp"
#include "relations/graph.hpp"

namespace isthmus {

/// The Fisher information of eq. 9 (Gauss-Newton's, robust losses as weights) of the poses of `patches` by
/// their (x, y, yaw) in the plane, over the relations among them; the first of `patches` is held, so block
/// row i belongs to patches[i + 1]. Not yet factored. `poses` is indexed by patch id.
BlockCholesky<3> reduced_information(const RelationGraph& graph, std::span<const Pose> poses,
                                     std::span<const PatchId> patches);

}  // namespace isthmus
