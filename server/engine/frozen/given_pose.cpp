#include "server/engine/frozen/given_pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "scanmatch/correlative.hpp"

namespace isthmus {
namespace {

bool is_on_island(const Map& map, PatchId id) { return id.valid() && id < map.manifold().next_id(); }

bool has_points(const Map& map, PatchId id) { return !map.manifold().patch(id).points.empty(); }

/// Points of the map around a pose, in the frame of its patch.
std::vector<Eigen::Vector2d> points_around(const Map& map, const ManifoldPose& pose, double within_m) {
  std::vector<Eigen::Vector2d> found;
  for (const PatchId id : map.graph().patches_of(map.graph().island(pose.patch))) {
    const Pose here_from_patch = map.relative_pose(pose.patch, id);
    if ((position(here_from_patch) - position(pose.patch_from_object)).norm() > within_m) continue;
    for (const ScanPoint& point : map.manifold().patch(id).points)
      found.push_back(here_from_patch * point.position);
  }
  return found;
}

/// Of several windows, which may overlap.
struct BestFit {
  Pose pose;
  double score = 0;
  double second_score = 0;  ///< of what fits best well apart from it
  bool exhausted = false;

  void take(const CorrelativeResult& found, const CommonOptions& options) {
    const Pose off = ominus(found.local_from_robot, pose);
    const bool is_another = !options.is_within(off, options.apart_m);
    const double lesser = is_another ? std::min(score, found.score) : 0;
    second_score = std::max({second_score, found.second_score, lesser});
    exhausted = exhausted || found.exhausted;
    if (found.score <= score) return;
    pose = found.local_from_robot;
    score = found.score;
  }
};

}  // namespace

GivenPoseReading read_given_pose(const InitialPoseEvent& event, const Map& map) {
  const bool in_plane = event.island.valid();
  const PatchId named = in_plane ? event.island : event.patch;
  if (!is_on_island(map, named) || (in_plane && map.graph().island(named) != named))
    return {std::nullopt, DropReason::unknown_patch};
  const Pose meant = in_plane ? event.pose : map.manifold().pose(named) * event.pose;
  std::optional<PatchId> nearest;
  double least = 0;
  for (const PatchId id : map.graph().patches_of(map.graph().island(named))) {
    const double distance = (position(map.manifold().pose(id)) - position(meant)).norm();
    if (!has_points(map, id) || (nearest && distance >= least)) continue;
    nearest = id;
    least = distance;
  }
  // No scan from there can have seen what the map shows.
  constexpr double farthest_m = 50;
  if (!nearest || !(least <= farthest_m)) return {std::nullopt, DropReason::off_the_map};
  return {ManifoldPose{*nearest, ominus(meant, map.manifold().pose(*nearest))}, DropReason::none};
}

void GivenPose::move(const Pose& step) {
  pose.patch_from_object = pose.patch_from_object * step;
  for (Pose& at : or_at) at = at * step;
}

std::optional<ManifoldPose> search_about(const GivenPose& given, const Map& map,
                                         std::span<const ScanPoint> points, const EngineOptions& options,
                                         NotFound& why) {
  const FrozenOptions& its = options.frozen;
  why = NotFound::given_pose_misfits;
  if (static_cast<int>(points.size()) < options.match.min_pairs) return std::nullopt;
  const double half_m = std::max(its.given_sigmas * given.sigma_m, options.correlative.cell_m);
  const double half_rad = std::min(its.given_sigmas * given.sigma_rad, std::numbers::pi);
  CorrelativeOptions search = options.correlative;
  search.max_evaluations = its.given_evaluations;
  BestFit best;
  const auto look_about = [&](const Pose& at) {
    const auto around = points_around(map, {given.pose.patch, at}, half_m + options.correlative.reach_m);
    best.take(search_window(around, points, {at, half_m, half_m, half_rad}, search), options.common);
  };
  look_about(given.pose.patch_from_object);
  for (const Pose& at : given.or_at) look_about(at);
  if (best.score < its.min_given_score) return std::nullopt;
  // A search that was not ended may have missed another place that fits as well.
  if (best.exhausted || best.second_score >= options.ambiguity.share * best.score) {
    why = NotFound::given_pose_ambiguous;
    return std::nullopt;
  }
  return ManifoldPose{given.pose.patch, best.pose};
}

}  // namespace isthmus
