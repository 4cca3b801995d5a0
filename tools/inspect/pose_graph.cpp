#include "tools/inspect/pose_graph.hpp"

#include "server/output/tables/graph_g2o.hpp"
#include "tools/text/g2o.hpp"
#include "tools/text/lines.hpp"

namespace isthmus {

PoseGraph read_pose_graph(const std::string& file) {
  const G2oFile read = read_g2o(file);
  PoseGraph result;
  for (const auto& [id, pose] : read.vertices) {
    const PatchId patch{static_cast<std::int32_t>(result.poses.size())};
    if (id != patch.value || !pose)
      throw FileError(file, 0, "vertex ids must be 0, 1, 2, ..., each with its pose");
    result.graph.add_patch(patch);
    result.poses.push_back(*pose);
  }
  for (const G2oFileEdge& edge : read.edges) {
    Relation relation;
    relation.a = PatchId{static_cast<std::int32_t>(edge.from)};
    relation.b = PatchId{static_cast<std::int32_t>(edge.to)};
    relation.kind = RelationKind::relative_pose;
    relation.measurement = relative_pose(G2oEdge{edge.from_to, edge.information});
    result.graph.add(relation);
  }
  return result;
}

}  // namespace isthmus
