#include "server/engine/map/surroundings.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

bool any_coarse(const RelationGraph& graph, std::span<const PatchId> patches) {
  return std::ranges::any_of(patches, [&](PatchId patch) {
    return std::ranges::any_of(graph.of(patch),
                               [&](RelationId id) { return !says_where_walls_are(*graph.find(id)); });
  });
}

}  // namespace

bool says_where_walls_are(const Relation& relation) {
  return relation.kind == RelationKind::odometry || is_match(relation);
}

bool is_match(const Relation& relation) {
  return relation.kind == RelationKind::point_to_line || relation.kind == RelationKind::point_to_point ||
         relation.kind == RelationKind::line_to_line;
}

double overlap_share(const Patch& patch, const Pose& patch_from_robot, std::span<const ScanPoint> points,
                     const SurroundingsOptions& options) {
  const std::size_t stride =
      std::max<std::size_t>(1, points.size() / static_cast<std::size_t>(options.overlap_points));
  const double c = std::cos(patch_from_robot.yaw);
  const double s = std::sin(patch_from_robot.yaw);
  int seen = 0;
  int near = 0;
  for (std::size_t i = stride / 2; i < points.size(); i += stride) {
    const Eigen::Vector2d& p = points[i].position;
    ++seen;
    if (patch.index.nearest(
            {c * p.x() - s * p.y() + patch_from_robot.x, s * p.x() + c * p.y() + patch_from_robot.y}) >= 0) {
      ++near;
    }
  }
  return seen == 0 ? 0 : static_cast<double>(near) / seen;
}

void Surroundings::update(const Map& map, PatchId reference, const EngineOptions& options, By by,
                          std::size_t max_patches) {
  if (reference == reference_ && max_patches == max_patches_ && by == by_ && map.stamp(looked_at_) == stamp_)
    return;
  max_patches_ = max_patches;
  by_ = by;
  reference_ = reference;
  patches_.clear();
  looked_at_ = map.graph().nearest_in_graph(reference, max_patches);
  stamp_ = map.stamp(looked_at_);
  const Pose& map_from_reference = map.manifold().pose(reference);
  using Covariances = std::map<PatchId, Eigen::Matrix3d>;
  const auto covariances_by = [&](const std::function<bool(const Relation&)>& counts) {
    return local_relative_covariances(map.graph(), map.manifold().poses(), reference, max_patches, counts);
  };
  const Covariances by_scans = by == By::all ? Covariances{} : covariances_by(says_where_walls_are);
  const bool are_alike = by == By::scans || (by == By::both && !any_coarse(map.graph(), looked_at_));
  const Covariances covariances = are_alike ? by_scans : covariances_by({});
  patches_.push_back({reference, Pose{}, Eigen::Matrix3d::Zero(), true, true});
  const ConfidenceThreshold loop{options.surroundings.loop_position_m, options.surroundings.loop_yaw_rad};
  for (const auto& [id, covariance] : covariances) {
    if (id == reference || !well_determined(covariance, loop)) continue;
    const auto fine = by_scans.find(id);
    patches_.push_back({id, ominus(map.manifold().pose(id), map_from_reference), covariance,
                        fine != by_scans.end() && well_determined(fine->second, options.local_map),
                        well_determined(covariance, options.local_map)});
  }
}

LocalMap Surroundings::local_map(const Map& map, const Pose& local_from_robot,
                                 std::span<const ScanPoint> points, const EngineOptions& options) const {
  struct Candidate {
    const Determined* determined;
    double distance_m;
  };
  std::vector<Candidate> candidates;
  for (const Determined& determined : patches_) {
    if (!determined.well_determined) continue;
    const Pose patch_from_robot = ominus(local_from_robot, determined.local_from_patch);
    const double distance = std::hypot(patch_from_robot.x, patch_from_robot.y);
    if (distance > options.surroundings.reach_m) continue;
    const double share =
        overlap_share(map.manifold().patch(determined.patch), patch_from_robot, points, options.surroundings);
    if (share < options.surroundings.min_overlap) continue;
    candidates.push_back({&determined, distance});
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.determined->patch < b.determined->patch; });
  const auto oldest = static_cast<std::size_t>(options.surroundings.oldest);
  const auto newest = static_cast<std::size_t>(options.surroundings.newest);
  if (candidates.size() > oldest + newest) {
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(oldest),
                     candidates.end() - static_cast<std::ptrdiff_t>(newest));
  }
  LocalMap local;
  local.reference = reference_;
  for (const Candidate& candidate : candidates) {
    local.patches.push_back(
        {map.manifold().shared_patch(candidate.determined->patch), candidate.determined->local_from_patch});
  }
  return local;
}

LocalMap Surroundings::nearest_patches(const Map& map, const Pose& local_from_robot,
                                       const SurroundingsOptions& options) const {
  const auto distance_m = [&](const Determined* determined) {
    const Pose& its = determined->local_from_patch;
    return std::hypot(its.x - local_from_robot.x, its.y - local_from_robot.y);
  };
  std::vector<const Determined*> near;
  for (const Determined& determined : patches_)
    if (determined.well_determined && distance_m(&determined) <= options.reach_m) near.push_back(&determined);
  std::ranges::stable_sort(near, {}, distance_m);
  near.resize(std::min(near.size(), options.max_patches()));
  LocalMap local;
  local.reference = reference_;
  for (const Determined* determined : near)
    local.patches.push_back({map.manifold().shared_patch(determined->patch), determined->local_from_patch});
  return local;
}

}  // namespace isthmus
