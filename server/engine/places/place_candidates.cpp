#include "server/engine/places/place_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>

#include "relations/confidence.hpp"

namespace isthmus {
namespace {

bool sees_walls(const Map& map, PatchId id) { return !map.manifold().patch(id).points.empty(); }

// Metres from one patch to all others of its island, over the fewest relations; negative: not on it.
std::vector<double> ways_m(const Map& map, PatchId from) {
  const RelationGraph& graph = map.graph();
  const auto at = [](PatchId id) { return static_cast<std::size_t>(id.value); };
  std::vector<double> ways(map.manifold().size(), -1);
  ways[at(from)] = 0;
  std::deque<PatchId> queue{from};
  while (!queue.empty()) {
    const PatchId id = queue.front();
    queue.pop_front();
    const Pose& pose = map.manifold().pose(id);
    for (const RelationId relation_id : graph.of(id)) {
      const Relation& relation = *graph.find(relation_id);
      const PatchId next = relation.a == id ? relation.b : relation.a;
      if (ways[at(next)] >= 0) continue;
      const Pose& its = map.manifold().pose(next);
      ways[at(next)] = ways[at(id)] + std::hypot(its.x - pose.x, its.y - pose.y);
      queue.push_back(next);
    }
  }
  return ways;
}

struct Rough {
  PatchId anchor;
  double way_m = 0;
  double surprise = 0;  ///< distance as a share of what drift could explain
};

// Anchors so far apart that each patch of `ranked` is near one of them.
std::vector<Rough> anchors_of(const Map& map, const std::vector<Rough>& ranked,
                              const PlaceCandidateOptions& options) {
  std::vector<Rough> anchors;
  for (const Rough& rough : ranked) {
    const Pose& pose = map.manifold().pose(rough.anchor);
    const bool covered = std::ranges::any_of(anchors, [&](const Rough& other) {
      const Pose& its = map.manifold().pose(other.anchor);
      return std::hypot(its.x - pose.x, its.y - pose.y) < options.spacing_m;
    });
    if (!covered) anchors.push_back(rough);
    if (anchors.size() >= options.max_places) break;
  }
  return anchors;
}

// What of the covariance's box is near the anchor; nothing where the two do not meet.
bool narrow(double& centre, double& half, double most, const PlaceCandidateOptions& options) {
  const double low = std::max(centre - most, -options.half_window_m - options.window_margin_m);
  const double high = std::min(centre + most, options.half_window_m + options.window_margin_m);
  if (high <= low) return false;
  centre = 0.5 * (low + high);
  half = 0.5 * (high - low);
  return true;
}

// Where the patch may be for all that its way may have drifted.
std::vector<Rough> rough_places(const Map& map, PatchId query, const PlaceCandidateOptions& options) {
  const Manifold& manifold = map.manifold();
  const Pose& here = manifold.pose(query);
  const std::vector<double> ways = ways_m(map, query);
  std::vector<Rough> rough;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (ways[i] < options.min_way_m) continue;
    const PatchId id{static_cast<std::int32_t>(i)};
    const Pose& its = manifold.pose(id);
    const double distance = std::hypot(its.x - here.x, its.y - here.y);
    const double drift = options.min_drift_m + options.drift_per_way * ways[i];
    if (distance > options.reach_m + drift || !sees_walls(map, id)) continue;
    rough.push_back({id, ways[i], distance / drift});
  }
  return rough;
}

// The place about an anchor that is known relative to the patch with this covariance; nothing where the two
// do not meet.
std::optional<PlaceCandidate> candidate_at(const Map& map, PatchId query, const Rough& anchor,
                                           const Eigen::Matrix3d& anchor_covariance,
                                           const PlaceCandidateOptions& options) {
  // The patch seen from the anchor, rather than the anchor from the patch.
  const Pose query_from_anchor = map.relative_pose(query, anchor.anchor);
  const Eigen::Matrix3d jacobian = inverse_jacobian(query_from_anchor);
  const Eigen::Matrix3d covariance = jacobian * anchor_covariance * jacobian.transpose();
  const Eigen::Vector3d known = covariance.diagonal();
  const Eigen::Vector3d window =
      (options.window_sigmas * options.window_sigmas * (known + drift_variance(anchor.way_m, options)))
          .cwiseSqrt();
  PlaceCandidate place;
  place.anchor = anchor.anchor;
  place.way_m = anchor.way_m;
  place.window.centre = inverse(query_from_anchor);
  if (!narrow(place.window.centre.x, place.window.half_x_m, window.x(), options) ||
      !narrow(place.window.centre.y, place.window.half_y_m, window.y(), options))
    return std::nullopt;
  place.window.half_yaw_rad = std::min(std::numbers::pi, window.z());
  place.sigma_m = std::sqrt((known + systematic_variance(anchor.way_m, options)).head<2>().sum());
  return place;
}

}  // namespace

Eigen::Vector3d systematic_variance(double way_m, const PlaceCandidateOptions& options) {
  const double position = options.systematic_m + options.systematic_share * way_m;
  const double yaw = options.systematic_rad + options.systematic_rad_per_m * way_m;
  return {position * position, position * position, yaw * yaw};
}

Eigen::Vector3d drift_variance(double way_m, const PlaceCandidateOptions& options) {
  const double position = (options.min_drift_m + options.drift_per_way * way_m) / options.window_sigmas;
  const double yaw = (options.min_drift_rad + options.drift_rad_per_m * way_m) / options.window_sigmas;
  return {position * position, position * position, yaw * yaw};
}

double revisit_log_odds(const Pose& off, double way_m, double sigma_m, const PlaceCandidateOptions& options) {
  const double variance = 0.5 * sigma_m * sigma_m;
  const double yaw_variance = systematic_variance(way_m, options).z();
  const double squared = (off.x * off.x + off.y * off.y) / variance + off.yaw * off.yaw / yaw_variance;
  const double density = std::exp(-0.5 * squared) /
                         (2 * std::numbers::pi * variance * std::sqrt(2 * std::numbers::pi * yaw_variance));
  const Eigen::Vector3d half = options.window_sigmas * drift_variance(way_m, options).cwiseSqrt();
  const double volume = 4 * half.x() * half.y() * 2 * std::min(std::numbers::pi, half.z());
  return std::log((1 - options.slip_probability) * density * volume + options.slip_probability);
}

std::vector<PlaceCandidate> places_on_own_island(const Map& map, PatchId query,
                                                 const PlaceCandidateOptions& options) {
  std::vector<Rough> rough = rough_places(map, query, options);
  if (rough.empty()) return {};
  std::ranges::stable_sort(rough, {}, &Rough::surprise);
  const std::vector<Rough> anchors = anchors_of(map, rough, options);
  std::vector<PatchId> others;
  for (const Rough& anchor : anchors) others.push_back(anchor.anchor);
  const auto covariances = exact_relative_covariances(map.graph(), map.manifold().poses(), query, others);
  std::vector<PlaceCandidate> places;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const auto place = candidate_at(map, query, anchors[i], covariances[i], options);
    if (place) places.push_back(*place);
  }
  return places;
}

std::vector<PlaceCandidate> places_on_other_islands(const Map& map, PatchId query,
                                                    const PlaceCandidateOptions& options) {
  std::vector<PlaceCandidate> places;
  const IslandId own = map.graph().island(query);
  for (const std::vector<PatchId>& island : map.graph().islands()) {
    if (island.size() < options.min_island || island.front() == own) continue;
    std::vector<Rough> patches;
    for (const PatchId id : island)
      if (sees_walls(map, id)) patches.push_back({id, 0, 0});
    for (const Rough& rough : anchors_of(map, patches, options)) {
      PlaceCandidate place;
      place.anchor = rough.anchor;
      place.window = {Pose{}, options.half_window_m, options.half_window_m, std::numbers::pi};
      places.push_back(place);
    }
  }
  return places;
}

}  // namespace isthmus
