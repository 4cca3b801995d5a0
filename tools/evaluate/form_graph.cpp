#include "tools/evaluate/form_graph.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace isthmus {
namespace {

using Vertices = std::map<std::int64_t, std::optional<Pose>>;

/// The pose of an edge's one end from the other's; whether that was possible and new.
bool extend(Vertices& vertices, const G2oFileEdge& edge) {
  std::optional<Pose>& from = vertices.at(edge.from);
  std::optional<Pose>& to = vertices.at(edge.to);
  if (from.has_value() == to.has_value()) return false;
  if (from)
    to = *from * edge.from_to;
  else
    from = *to * inverse(edge.from_to);
  return true;
}

void follow_odometry(Vertices& vertices, const std::map<std::int64_t, const G2oFileEdge*>& odometry) {
  for (auto step = odometry.begin(); step != odometry.end(); ++step) extend(vertices, *step->second);
  for (auto step = odometry.rbegin(); step != odometry.rend(); ++step) extend(vertices, *step->second);
}

/// Missing poses are composed: as far as consecutive ids lead, then over one other edge, and so on; each part
/// of the graph that has no pose at all starts at the origin.
void complete_poses(G2oFile& file) {
  std::map<std::int64_t, const G2oFileEdge*> odometry;
  for (const G2oFileEdge& edge : file.edges)
    if (std::abs(edge.to - edge.from) == 1) odometry.emplace(std::min(edge.from, edge.to), &edge);
  while (true) {
    follow_odometry(file.vertices, odometry);
    const auto extends = [&](const G2oFileEdge& edge) { return extend(file.vertices, edge); };
    if (std::any_of(file.edges.begin(), file.edges.end(), extends)) continue;
    const auto without = std::find_if(file.vertices.begin(), file.vertices.end(),
                                      [](const auto& vertex) { return !vertex.second; });
    if (without == file.vertices.end()) return;
    without->second = Pose{};
  }
}

Relation relation_of(const G2oFileEdge& edge, PatchId from, PatchId to) {
  const double yaw_weight = std::sqrt(2 * edge.information(2, 2));
  const double position_weight = std::sqrt(2 / edge.information.topLeftCorner<2, 2>().inverse().trace());
  const Vector5d measured = form_variables(edge.from_to);
  QuadraticFormBuilder builder;
  for (int k = 0; k < 4; ++k) {
    Vector5d row = Vector5d::Zero();
    row(k) = 1;
    row(4) = -measured(k);
    builder.row((k < 2 ? yaw_weight : position_weight) * row);
  }
  Relation relation;
  relation.a = from;
  relation.b = to;
  relation.kind = RelationKind::relative_pose;
  relation.measurement = Correspondences{builder.build(), 1, {}};
  return relation;
}

}  // namespace

FormGraph form_graph(G2oFile file) {
  complete_poses(file);
  FormGraph result;
  std::map<std::int64_t, PatchId> patch;
  for (const auto& [id, pose] : file.vertices) {
    const PatchId next{static_cast<std::int32_t>(result.poses.size())};
    patch.emplace(id, next);
    result.graph.add_patch(next);
    result.poses.push_back(*pose);
  }
  for (const G2oFileEdge& edge : file.edges)
    result.graph.add(relation_of(edge, patch.at(edge.from), patch.at(edge.to)));
  return result;
}

}  // namespace isthmus
