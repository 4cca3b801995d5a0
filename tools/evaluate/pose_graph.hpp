#pragma once

#include <string>

namespace isthmus {

/// What one batch fit made of a pose graph. F = Σ κ‖R_j − R_i R̃‖² + τ‖t_j − t_i − R_i t̃‖²
/// (tools/evaluate/form_graph.hpp).
struct PoseGraphFit {
  std::size_t patches = 0;
  std::size_t relations = 0;
  std::size_t islands = 0;
  double f_before = 0;  ///< at the file's vertices, or at odometry where it has none
  double f_after = 0;
  int iterations = 0;
  double cpu_s = 0;     ///< of the fit alone
  std::string failure;  ///< why there is no solution; empty: there is
};

/// Reads a g2o file, plain or gz, and fits each of its islands. Throws FileError naming file, line and
/// reason.
PoseGraphFit fit_pose_graph(const std::string& file);

}  // namespace isthmus
