#include "scanmatch/match_relations.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace isthmus {

double relation_sigma_m(const MatchQuality& quality, const MatchRelationOptions& options) {
  return options.sigma_per_rms * std::max(quality.rms_m, options.min_rms_m);
}

std::vector<Relation> match_relations(const LocalMap& local_map, std::span<const ScanPoint> points,
                                      const Match& match, PatchId new_patch, const Origin& origin,
                                      const MatchRelationOptions& options) {
  std::vector<QuadraticFormBuilder> builders(local_map.patches.size());
  const double sigma_m = relation_sigma_m(match.quality, options);
  for (const Pair& pair : match.pairs) {
    if (pair.weight < options.min_weight) continue;
    const LocalPatch& local = local_map.patches[static_cast<std::size_t>(pair.patch)];
    const ScanPoint& line = local.patch->points[static_cast<std::size_t>(pair.line)];
    const Eigen::Vector2d& point = points[static_cast<std::size_t>(pair.point)].position;
    const Eigen::Vector2d at = ominus(match.local_from_robot, local.local_from_patch) * point;
    // The line as the match trusted it: turned away from a direction that few beams hold, its residual at the
    // match's pose as it was.
    const double patch_yaw = local.local_from_patch.yaw;
    const Eigen::Vector2d trusted =
        rotate(-patch_yaw, match.direction_trust * rotate(patch_yaw, line.normal));
    const double length = trusted.norm();
    if (length < options.min_trust) continue;
    const Eigen::Vector2d normal = trusted / length;
    const double residual = line.normal.dot(at - line.position) / length;
    builders[static_cast<std::size_t>(pair.patch)].point_on_line(point, at - residual * normal, normal,
                                                                 sigma_m / (length * std::sqrt(pair.weight)));
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
