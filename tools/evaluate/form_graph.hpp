#pragma once

#include <vector>

#include "relations/graph.hpp"
#include "tools/text/g2o.hpp"

namespace isthmus {

/// A pose graph as relations: patch i is the i-th lowest vertex id of the file.
struct FormGraph {
  RelationGraph graph;
  /// From the vertices; where they have no pose, composed along the edges, those between consecutive ids
  /// (odometry) before others.
  std::vector<Pose> poses;
};

/// An edge (x̃, ỹ, yaw) with information Ω becomes a Correspondences relation whose |R v|² is
///
///     κ‖R_j − R_i R̃‖² + τ‖t_j − t_i − R_i t̃‖²,   κ = Ω_θθ,  τ = 2 / tr(Ω_xy⁻¹)
///
/// (the cost F of Rosen et al., SE-Sync, IJRR 2019): the rows √(2κ)(c − c̃), √(2κ)(s − s̃), √τ(x − x̃),
/// √τ(y − ỹ). F of the graph is twice the cost that `fit` reports.
FormGraph form_graph(G2oFile file);

}  // namespace isthmus
