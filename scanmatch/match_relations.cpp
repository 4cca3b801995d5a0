#include "scanmatch/match_relations.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace isthmus {
namespace {

// What a pair says, the line as the match trusted it: turned away from a direction that few beams hold.
struct Row {
  std::size_t patch = 0;
  Eigen::Vector2d point;     // of the scan
  Eigen::Vector2d at;        // where it came to lie, in the patch
  Eigen::Vector2d trusted;   // the line's normal in the patch, shortened
  Eigen::Vector3d jacobian;  // of the residual of the whole normal by the pose (x, y, yaw) in the local map
  double residual = 0;
  double weight = 0;
};

Row row_of(const LocalMap& local_map, std::span<const ScanPoint> points, const Match& match,
           const Pair& pair) {
  Row row;
  row.patch = static_cast<std::size_t>(pair.patch);
  const LocalPatch& local = local_map.patches[row.patch];
  const ScanPoint& line = local.patch->points[static_cast<std::size_t>(pair.line)];
  const double patch_yaw = local.local_from_patch.yaw;
  row.point = points[static_cast<std::size_t>(pair.point)].position;
  row.at = ominus(match.local_from_robot, local.local_from_patch) * row.point;
  const Eigen::Vector2d normal = rotate(patch_yaw, line.normal);
  row.trusted = rotate(-patch_yaw, match.direction_trust * normal);
  const Eigen::Vector2d arm = rotate(match.local_from_robot.yaw, row.point);
  row.jacobian = {normal.x(), normal.y(), normal.y() * arm.x() - normal.x() * arm.y()};
  row.residual = line.distance_from_line_m(row.at);
  row.weight = pair.weight;
  return row;
}

std::vector<Row> rows_of(const LocalMap& local_map, std::span<const ScanPoint> points, const Match& match,
                         const MatchRelationOptions& options) {
  std::vector<Row> rows;
  for (const Pair& pair : match.pairs) {
    if (pair.weight < options.min_weight) continue;
    const Row row = row_of(local_map, points, match, pair);
    if (row.trusted.norm() >= options.min_trust) rows.push_back(row);
  }
  return rows;
}

// By patches: what is not trusted of the step that the rows would make by themselves from where the match
// came to rest. Left to pull, beams that are trusted little would pull far: a line whose normal is shortened
// tells of the same distance, with less of a lever.
std::vector<Eigen::Vector3d> untrusted_steps(std::size_t patches, std::span<const Row> rows,
                                             const Eigen::Matrix2d& direction_trust) {
  constexpr double damping = 1e-3;  // where no beam tells, none would step
  std::vector<Eigen::Matrix3d> h(patches, damping * Eigen::Matrix3d::Identity());
  std::vector<Eigen::Vector3d> g(patches, Eigen::Vector3d::Zero());
  for (const Row& row : rows) {
    h[row.patch] += row.weight * row.jacobian * row.jacobian.transpose();
    g[row.patch] += row.weight * row.residual * row.jacobian;
  }
  std::vector<Eigen::Vector3d> steps(patches, Eigen::Vector3d::Zero());
  for (std::size_t k = 0; k < patches; ++k) {
    const Eigen::Vector3d step = -h[k].ldlt().solve(g[k]);
    steps[k].head<2>() = step.head<2>() - direction_trust * step.head<2>();
  }
  return steps;
}

}  // namespace

double relation_sigma_m(const MatchQuality& quality, const MatchRelationOptions& options) {
  return options.sigma_per_rms * std::max(quality.rms_m, options.min_rms_m);
}

std::vector<Relation> match_relations(const LocalMap& local_map, std::span<const ScanPoint> points,
                                      const Match& match, PatchId new_patch, const Origin& origin,
                                      const MatchRelationOptions& options) {
  std::vector<QuadraticFormBuilder> builders(local_map.patches.size());
  const double sigma_m = relation_sigma_m(match.quality, options);
  const std::vector<Row> rows = rows_of(local_map, points, match, options);
  const std::vector<Eigen::Vector3d> steps =
      untrusted_steps(local_map.patches.size(), rows, match.direction_trust);
  for (const Row& row : rows) {
    const double length = row.trusted.norm();
    const Eigen::Vector2d normal = row.trusted / length;
    const double residual = (row.residual + row.jacobian.dot(steps[row.patch])) / length;
    builders[row.patch].point_on_line(row.point, row.at - residual * normal, normal,
                                      sigma_m / (length * std::sqrt(row.weight)));
  }
  std::vector<Relation> relations;
  for (std::size_t k = 0; k < builders.size(); ++k) {
    if (builders[k].rows() < options.min_correspondences) continue;
    Relation relation;
    relation.a = local_map.patches[k].patch->id;
    relation.b = new_patch;
    relation.kind = RelationKind::point_to_line;
    relation.measurement = Correspondences{builders[k].build(), builders[k].rows(), {}};
    relation.origin = origin;
    relations.push_back(std::move(relation));
  }
  return relations;
}

}  // namespace isthmus
