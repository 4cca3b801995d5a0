#pragma once

#include <string>
#include <vector>

#include "relations/graph.hpp"

namespace isthmus {

/// The relations of a map with its fitted poses (by patch id, in each island's frame): what confidence needs.
struct PoseGraph {
  RelationGraph graph;
  std::vector<Pose> poses;
};

/// Reads an exported graph.g2o: every edge is a RelativePose relation with the information it had at its
/// minimiser. Vertex ids must be 0, 1, 2, ... and have poses. Throws FileError naming file and reason.
PoseGraph read_pose_graph(const std::string& file);

}  // namespace isthmus
