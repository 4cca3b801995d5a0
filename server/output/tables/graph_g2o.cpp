#include "server/output/tables/graph_g2o.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "server/output/format/atomic_file.hpp"
#include "server/output/format/number.hpp"

namespace isthmus {
namespace {

/// (x, y, yaw) of a_from_b less those of the measured pose = a_from_error * e, with g2o's error e seen from
/// the measured pose.
Eigen::Matrix3d a_from_error(const Pose& measured_a_from_b) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.col(0).head<2>() = rotate(measured_a_from_b.yaw, Eigen::Vector2d::UnitX());
  turn.col(1).head<2>() = rotate(measured_a_from_b.yaw, Eigen::Vector2d::UnitY());
  return turn;
}

/// Solvers ask for a positive definite information, which a range or a bearing alone does not have: what was
/// not measured is given a sigma of 1 km or 1000 rad, or what share of the largest weight a double can still
/// tell from none once it is squared, where that is more.
Eigen::Matrix3d positive_definite(const Eigen::Matrix3d& information) {
  constexpr double least = 1e-6, min_share = 1e-11;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  const double floor = std::max(least, min_share * eigen.eigenvalues()(2));
  if (eigen.eigenvalues()(0) >= floor) return information;
  const Eigen::Vector3d raised = eigen.eigenvalues().cwiseMax(floor);
  const Eigen::Matrix3d whole = eigen.eigenvectors() * raised.asDiagonal() * eigen.eigenvectors().transpose();
  return 0.5 * (whole + whole.transpose());
}

std::string pose_text(const Pose& pose) {
  return number(pose.x) + " " + number(pose.y) + " " + number(pose.yaw);
}

std::string fix_line(PatchId id) { return "FIX " + std::to_string(id.value) + "\n"; }

std::string edge_line(const Relation& relation, const G2oEdge& edge) {
  std::string line = "EDGE_SE2 " + std::to_string(relation.a.value) + " " + std::to_string(relation.b.value) +
                     " " + pose_text(edge.measured_a_from_b);
  const Eigen::Matrix3d information = positive_definite(edge.information);
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) line += " " + number(information(row, column));
  }
  return line + "\n";
}

}  // namespace

G2oEdge g2o_edge(const Relation& relation, const Pose& fitted_a_from_b) {
  const Pose z = minimiser(relation.measurement, fitted_a_from_b);
  const Eigen::Matrix3d turn = a_from_error(z);
  const double weight =
      robust_weight(chi_squared(relation.measurement, fitted_a_from_b), relation.robust_scale);
  const Eigen::Matrix3d by_pose = weight * information(relation.measurement, z);
  return {z, turn.transpose() * by_pose * turn};
}

RelativePose relative_pose(const G2oEdge& edge) {
  const Eigen::Matrix3d turn = a_from_error(edge.measured_a_from_b);
  return {edge.measured_a_from_b, turn * edge.information * turn.transpose()};
}

void write_g2o(const MapCopy& map, const RankedIslands& islands, const std::string& path) {
  AtomicFile file(path);
  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    file.write("VERTEX_SE2 " + std::to_string(map.patches[i]->id.value) + " " + pose_text(map.poses[i]) +
               "\n");
  }
  for (const std::vector<PatchId>& patches : islands.patches) file.write(fix_line(patches.front()));
  for (const std::vector<PatchId>& patches : map.graph.islands()) {
    if (islands.rank(patches.front()) < 0) file.write(fix_line(patches.front()));  // nothing but tags
  }
  for (const auto& [id, relation] : map.graph.relations()) {
    const Pose& map_from_a = map.poses[static_cast<std::size_t>(relation.a.value)];
    const Pose& map_from_b = map.poses[static_cast<std::size_t>(relation.b.value)];
    file.write(edge_line(relation, g2o_edge(relation, ominus(map_from_b, map_from_a))));
  }
  file.commit();
}

}  // namespace isthmus
