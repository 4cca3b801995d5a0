#include "server/engine/map/local_loop.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "scanmatch/correlative.hpp"
#include "scanmatch/match_relations.hpp"
#include "scanmatch/score_profile.hpp"
#include "server/engine/map/drift.hpp"
#include "server/engine/map/in_view.hpp"

namespace isthmus {
namespace {

// Whether patches lie near in projection that the surroundings do not know, but that a wider look at the
// graph could: as near as any whose window can be searched whole.
bool others_near(const Map& map, const Surroundings& surroundings, const Pose& local_from_robot,
                 const EngineOptions& options) {
  const Pose map_from_robot = map.manifold().pose(surroundings.reference()) * local_from_robot;
  const double reach = options.surroundings.reach_m + std::numbers::sqrt2 * options.local_loops.max_window_m /
                                                          options.local_loops.window_sigmas;
  std::vector<bool> known(map.manifold().size(), false);
  for (const Determined& determined : surroundings.patches())
    known[static_cast<std::size_t>(determined.patch.value)] = true;
  const std::vector<PatchId> wider =
      map.graph().nearest_in_graph(surroundings.reference(), options.surroundings.loop_patches);
  return std::ranges::any_of(wider, [&](PatchId id) {
    const Pose& pose = map.manifold().pose(id);
    return !known[static_cast<std::size_t>(id.value)] &&
           std::hypot(pose.x - map_from_robot.x, pose.y - map_from_robot.y) < reach;
  });
}

bool is_loose(const Determined& determined, std::span<const PatchId> unpaired) {
  return !determined.well_determined ||
         std::find(unpaired.begin(), unpaired.end(), determined.patch) != unpaired.end();
}

// The nearest of the patches asked for that the scan could overlap, wherever in its covariance it is.
const Determined* nearest_among(const Surroundings& surroundings, const LoopQuery& query,
                                const EngineOptions& options) {
  const Determined* nearest = nullptr;
  double nearest_m = 0;
  for (const Determined& determined : surroundings.patches()) {
    if (!query.among(determined)) continue;
    const Pose patch_from_robot = ominus(query.local_from_robot, determined.local_from_patch);
    const double distance = std::hypot(patch_from_robot.x, patch_from_robot.y);
    const double slack = std::sqrt(determined.covariance.topLeftCorner<2, 2>().trace());
    if (distance > options.surroundings.reach_m + slack) continue;
    if (nearest && distance >= nearest_m) continue;
    nearest = &determined;
    nearest_m = distance;
  }
  return nearest;
}

// The anchor's own well-determined surroundings near the robot, as far as they are asked for.
LocalMap rigid_map(const Map& map, const Surroundings& surroundings, const LoopQuery& query,
                   const Surroundings& around_anchor, const Pose& anchor_from_robot, double slack_m,
                   const EngineOptions& options) {
  LocalMap local;
  local.reference = around_anchor.reference();
  for (const Determined& determined : around_anchor.patches()) {
    const Pose patch_from_robot = ominus(anchor_from_robot, determined.local_from_patch);
    if (!determined.well_determined ||
        std::hypot(patch_from_robot.x, patch_from_robot.y) > options.surroundings.reach_m + slack_m)
      continue;
    const bool wanted =
        std::any_of(surroundings.patches().begin(), surroundings.patches().end(),
                    [&](const Determined& d) { return d.patch == determined.patch && query.among(d); });
    if (wanted)
      local.patches.push_back({map.manifold().shared_patch(determined.patch), determined.local_from_patch});
  }
  if (local.patches.size() > options.surroundings.max_patches())
    local.patches.resize(options.surroundings.max_patches());
  return local;
}

// Whether a match is good enough: over all beams, or over those that found something to pair with.
bool fits(const Match& match, const LoopQuery& query, const LocalLoopOptions& options) {
  if (!match.ok) return false;
  if (!query.partly_known) return match.quality.score >= options.common.sure_score;
  const double paired = static_cast<double>(match.quality.paired_beams) / std::max(1, match.quality.beams);
  return paired >= options.min_paired && match.quality.score >= options.common.sure_score * paired;
}

bool within_window(const Eigen::Matrix3d& covariance, const LocalLoopOptions& options) {
  const auto fits = [&](int i, double max) {
    return options.window_sigmas * std::sqrt(covariance(i, i)) <= max;
  };
  return fits(0, options.max_window_m) && fits(1, options.max_window_m) && fits(2, options.max_window_rad);
}

SearchWindow window_about(const Pose& anchor_from_robot, const Eigen::Matrix3d& covariance,
                          const LocalLoopOptions& options) {
  const auto half_width = [&](int i, double max) {
    return std::min(max, options.window_sigmas * std::sqrt(covariance(i, i)));
  };
  return {anchor_from_robot, half_width(0, options.max_window_m), half_width(1, options.max_window_m),
          half_width(2, options.max_window_rad)};
}

double widest_half_m(const SearchWindow& window) { return std::max(window.half_x_m, window.half_y_m); }

// The scan's fit within the window, as wide as the walls leave it open; none where it does not fit well, fits
// elsewhere about as well, or is farther from where the map has it than `information` lets it be.
std::optional<Match> match_in_window(const LocalMap& local, const LoopQuery& query,
                                     const SearchWindow& window, const Eigen::Matrix3d& information,
                                     bool unambiguous, const EngineOptions& options) {
  const LocalLoopOptions& its = options.local_loops;
  const CorrelativeResult search = search_window(local, query.points, window, options.correlative);
  if (search.score <= 0 || search.exhausted) return std::nullopt;
  if (!unambiguous && search.second_score > options.ambiguity.share * search.score) return std::nullopt;
  Match match =
      match_scan(local, query.points, {search.local_from_robot, options.localise.loose_share * information},
                 options.match);
  if (!fits(match, query, its) || (!unambiguous && match.quality.degenerate)) return std::nullopt;
  const Eigen::Vector3d innovation = wrapped_difference(match.local_from_robot, window.centre);
  if (innovation.dot(information * innovation) > its.common.surprise.bound(3)) return std::nullopt;

  const double weak_sigma_m = sigma_along_weak_direction(
      local, query.points, match, std::min(widest_half_m(window), its.unambiguous_half_width_m),
      options.match, options.weak_direction);
  widen(match, weak_sigma_m, relation_sigma_m(match.quality, options.relations), options.match);
  return match;
}

}  // namespace

LocalLoop match_loop(const Map& map, const Surroundings& surroundings, const LoopQuery& query,
                     const EngineOptions& options) {
  LocalLoop found;
  found.patch = query.patch;
  const Determined* anchor = nearest_among(surroundings, query, options);
  if (!anchor) return found;
  Surroundings around_anchor;
  around_anchor.update(map, anchor->patch, options, Surroundings::By::scans);

  // The robot seen from the anchor: the covariance of the inverse pose.
  const Pose anchor_from_robot = ominus(query.local_from_robot, anchor->local_from_patch);
  const Eigen::Matrix3d jacobian = ominus_jacobians(query.local_from_robot, anchor->local_from_patch).by_pi;
  Eigen::Matrix3d covariance = jacobian * anchor->covariance * jacobian.transpose();
  // A slip of the past is in no covariance, and here is the last chance to mend it.
  const LocalLoopOptions& its = options.local_loops;
  covariance.diagonal() += systematic_variance(0, options.place_candidates);
  const Eigen::Matrix3d information = covariance.inverse();
  if (query.whole_window && !within_window(covariance, its)) return found;
  const SearchWindow window = window_about(anchor_from_robot, covariance, its);
  const double widest_m = widest_half_m(window);
  found.unambiguous = widest_m <= its.unambiguous_half_width_m;

  const LocalMap local =
      rigid_map(map, surroundings, query, around_anchor, anchor_from_robot, widest_m, options);
  if (local.patches.empty()) return found;
  found.compared = true;
  const std::optional<Match> match =
      match_in_window(local, query, window, information, found.unambiguous, options);
  if (!match) {
    const InView view = in_view(local, query.points, anchor_from_robot, options.contradiction);
    found.would_show = view.share() >= its.min_paired;
    return found;
  }

  const Pose map_from_anchor = map.manifold().pose(anchor->patch);
  const Pose before = map_from_anchor * anchor_from_robot;
  found.map_from_map = map_from_anchor * match->local_from_robot * inverse(before);
  found.position = position(before);
  found.relations =
      match_relations(local, query.points, *match, query.patch, query.origin, options.relations);
  return found;
}

LocalLoop find_local_loop(const Map& map, const Surroundings& near_surroundings, const Pose& local_from_robot,
                          std::span<const ScanPoint> points, std::span<const PatchId> unpaired,
                          PatchId new_patch, const EngineOptions& options) {
  Surroundings surroundings = near_surroundings;
  if (others_near(map, surroundings, local_from_robot, options)) {
    surroundings.update(map, surroundings.reference(), options, Surroundings::By::both,
                        options.surroundings.loop_patches);
  }
  LoopQuery query;
  query.local_from_robot = local_from_robot;
  query.points = points;
  query.among = [&](const Determined& determined) { return is_loose(determined, unpaired); };
  query.patch = new_patch;
  query.origin = {OriginKind::match, {}};
  query.whole_window = true;
  return match_loop(map, surroundings, query, options);
}

std::vector<Relation> WaitingLoops::take(LocalLoop found, const LocalLoopOptions& options) {
  if (found.relations.empty()) return {};
  if (found.unambiguous) return std::move(found.relations);
  const CommonOptions& its = options.common;
  // Two finds agree where they would move the map alike, seen where they are.
  const auto agree = [&](const LocalLoop& other) {
    const Eigen::Vector2d mine = found.map_from_map * found.position;
    const Eigen::Vector2d theirs = other.map_from_map * found.position;
    return (mine - theirs).norm() < its.agreeing_m &&
           std::abs(wrap_angle(found.map_from_map.yaw - other.map_from_map.yaw)) <
               its.yaw_rad(its.agreeing_m);
  };
  std::vector<Relation> relations = found.relations;
  int agreeing = 1;
  double way_m = 0;
  for (const LocalLoop& other : waiting_) {
    if (!agree(other)) continue;
    ++agreeing;
    way_m = std::max(way_m, (other.position - found.position).norm());
    relations.insert(relations.end(), other.relations.begin(), other.relations.end());
  }
  if (agreeing >= its.agreeing && way_m >= options.min_way_m) {
    waiting_.clear();
    return relations;
  }
  waiting_.push_back(std::move(found));
  if (waiting_.size() > its.max_finds) waiting_.pop_front();
  return {};
}

}  // namespace isthmus
