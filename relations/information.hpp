#pragma once

#include <functional>
#include <span>

#include "relations/block_cholesky.hpp"
#include "relations/graph.hpp"

namespace isthmus {

/// The Fisher information of eq. 9 (Gauss-Newton's, robust losses as weights) of the poses of `patches` by
/// their (x, y, yaw) in the plane, over the relations among them; the first of `patches` is held, so block
/// row i belongs to patches[i + 1]. Not yet factored. `poses` is indexed by patch id.
/// Relations that `counts` says no to are left out.
BlockCholesky<3> reduced_information(const RelationGraph& graph, std::span<const Pose> poses,
                                     std::span<const PatchId> patches,
                                     const std::function<bool(const Relation&)>& counts = {});

}  // namespace isthmus
