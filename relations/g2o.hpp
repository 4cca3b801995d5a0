#pragma once

#include <istream>
#include <string>
#include <variant>
#include <vector>

#include "relations/graph.hpp"

namespace isthmus {

/// A pose graph as relations: patch i is the i-th lowest vertex id of the file.
struct PoseGraphFile {
  RelationGraph graph;
  /// From the VERTEX_SE2 lines; where there are none, composed along the edges, those between consecutive ids
  /// (odometry) before others.
  std::vector<Pose> poses;
};

/// Reads the VERTEX_SE2 and EDGE_SE2 lines of a g2o file (FIX lines are skipped). An edge (x̃, ỹ, yaw) with
/// information Ω becomes a Correspondences relation whose |R v|² is
///
///     κ‖R_j − R_i R̃‖² + τ‖t_j − t_i − R_i t̃‖²,   κ = Ω_θθ,  τ = 2 / tr(Ω_xy⁻¹)
///
/// (the cost F of Rosen et al., SE-Sync, IJRR 2019): the rows √(2κ)(c − c̃), √(2κ)(s − s̃), √τ(x − x̃),
/// √τ(y − ỹ). F of the graph is twice the cost that `fit` reports.
///
/// Errors are a message with file name, line and reason.
std::variant<PoseGraphFile, std::string> read_g2o(std::istream& stream, const std::string& file_name);

}  // namespace isthmus
