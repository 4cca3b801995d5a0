#include "server/engine/places/place_candidates.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
namespace isthmus {
namespace {

bool sees_walls(const Map& map, PatchId id) { return !map.manifold().patch(id).points.empty(); }

struct Rough {
  PatchId anchor;
  double way_m = 0;
  double surprise = 0;  ///< distance as a share of what drift could explain; below zero where a hint has it
};

// Which of the places seen so far are near: looked up by cell.
class Spread {
 public:
  explicit Spread(double spacing_m) : spacing_m_(spacing_m) {}

  /// Whether nothing that was added before lies nearer than the spacing.
  bool add(const Pose& pose) {
    const auto [x, y] = cell(pose);
    for (int i = x - 1; i <= x + 1; ++i) {
      for (int k = y - 1; k <= y + 1; ++k) {
        const auto found = cells_.find({i, k});
        if (found != cells_.end() && std::ranges::any_of(found->second, [&](const Pose& its) {
              return std::hypot(its.x - pose.x, its.y - pose.y) < spacing_m_;
            }))
          return false;
      }
    }
    cells_[{x, y}].push_back(pose);
    return true;
  }

 private:
  std::pair<int, int> cell(const Pose& pose) const {
    return {static_cast<int>(std::floor(pose.x / spacing_m_)),
            static_cast<int>(std::floor(pose.y / spacing_m_))};
  }

  double spacing_m_;
  std::map<std::pair<int, int>, std::vector<Pose>> cells_;
};

// Of more places than can be searched at once the first half, and others in turn: a golden section further
// round from patch to patch, so that none waits long.
std::vector<Rough> taken_in_turn(std::vector<Rough> anchors, PatchId query, std::size_t most) {
  if (anchors.size() <= most) return anchors;
  constexpr double golden = 0.6180339887498949;
  const std::size_t first = most / 2;
  const std::size_t rest = anchors.size() - first;
  const double turns = golden * query.value;
  const auto from = static_cast<std::size_t>((turns - std::floor(turns)) * static_cast<double>(rest));
  std::vector<Rough> taken(anchors.begin(), anchors.begin() + static_cast<std::ptrdiff_t>(first));
  for (std::size_t i = 0; taken.size() < most; ++i) taken.push_back(anchors[first + (from + i) % rest]);
  return taken;
}

// Anchors so far apart that each patch of `ranked` is near one of them.
std::vector<Rough> anchors_of(const Map& map, std::vector<Rough> ranked, PatchId query,
                              const PlaceCandidateOptions& options) {
  std::ranges::stable_sort(ranked, {}, &Rough::surprise);
  Spread spread(options.spacing_m);
  std::vector<Rough> anchors;
  for (const Rough& rough : ranked)
    if (spread.add(map.manifold().pose(rough.anchor))) anchors.push_back(rough);
  return taken_in_turn(std::move(anchors), query, options.max_places);
}

// How far a place is from where hints have the patch, as a share of what they may err by, less one; nothing
// where none has it near.
std::optional<double> hinted(const Pose& place, IslandId island, std::span<const PlaceHint> hints,
                             const PlaceCandidateOptions& options) {
  double least = 1;
  for (const PlaceHint& hint : hints) {
    if (hint.island != island) continue;
    const Pose& there = hint.island_from_patch;
    least =
        std::min(least, std::hypot(place.x - there.x, place.y - there.y) / (options.reach_m + hint.drift_m));
  }
  if (least >= 1) return std::nullopt;
  return least - 1;
}

// What of the covariance's box is near the anchor; nothing where the two do not meet.
bool narrow(double& centre, double& half, double most, const PlaceCandidateOptions& options) {
  const double low = std::max(centre - most, -options.spacing_m - options.window_margin_m);
  const double high = std::min(centre + most, options.spacing_m + options.window_margin_m);
  if (high <= low) return false;
  centre = 0.5 * (low + high);
  half = 0.5 * (high - low);
  return true;
}

// Where the patch may be for all that its way may have drifted.
std::vector<Rough> rough_places(const Map& map, const PlaceQuestion& question, const WayNetwork& network,
                                const PlaceCandidateOptions& options) {
  const Manifold& manifold = map.manifold();
  const PatchId query = question.newest_first.front();
  const auto may_lie_on = [&](PatchId id) {
    return sees_walls(map, id) &&
           std::ranges::find(question.not_of, manifold.patch(id).robot) == question.not_of.end();
  };
  const Pose& here = manifold.pose(query);
  const IslandId island = map.graph().island(query);
  const std::vector<double> ways = network.ways_m(std::span(&query, 1));
  std::vector<Rough> rough;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (ways[i] < options.min_way_m || std::isinf(ways[i])) continue;
    const PatchId id{static_cast<std::int32_t>(i)};
    const Pose& its = manifold.pose(id);
    const double distance = std::hypot(its.x - here.x, its.y - here.y);
    const double drift = options.min_drift_m + options.drift_per_way * ways[i];
    if (distance > options.reach_m + drift || !may_lie_on(id)) continue;
    rough.push_back({id, ways[i], hinted(its, island, question.hints, options).value_or(distance / drift)});
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
      (std::pow(options.common.window_sigmas, 2) * (known + drift_variance(anchor.way_m, options)))
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

std::vector<PlaceCandidate> places_on_own_island(const Map& map, const PlaceQuestion& question,
                                                 const WayNetwork& network, const IslandCovariances& island,
                                                 const PlaceCandidateOptions& options) {
  const PatchId query = question.newest_first.front();
  std::vector<Rough> rough = rough_places(map, question, network, options);
  if (rough.empty()) return {};
  const std::vector<Rough> anchors = anchors_of(map, std::move(rough), query, options);
  std::vector<PatchId> others;
  for (const Rough& anchor : anchors) others.push_back(anchor.anchor);
  const std::vector<Eigen::Matrix3d> covariances = island.relative_to(query, others);
  std::vector<PlaceCandidate> places;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const auto place = candidate_at(map, query, anchors[i], covariances[i], options);
    if (place) places.push_back(*place);
  }
  return places;
}

std::vector<PlaceCandidate> places_on_other_islands(const Map& map, PatchId query,
                                                    std::span<const PlaceHint> hints,
                                                    const PlaceCandidateOptions& options) {
  std::vector<PlaceCandidate> places;
  const IslandId own = map.graph().island(query);
  for (const std::vector<PatchId>& patches : map.graph().islands()) {
    if (patches.size() < options.min_island || patches.front() == own) continue;
    const IslandId island = map.graph().island(patches.front());
    std::vector<Rough> rough;
    for (const PatchId id : patches)
      if (sees_walls(map, id))
        rough.push_back({id, 0, hinted(map.manifold().pose(id), island, hints, options).value_or(0)});
    for (const Rough& anchor : anchors_of(map, std::move(rough), query, options)) {
      PlaceCandidate place;
      place.anchor = anchor.anchor;
      place.window = {Pose{}, options.spacing_m, options.spacing_m, std::numbers::pi};
      places.push_back(place);
    }
  }
  return places;
}

std::vector<PlaceCandidate> places_on_islands_in_turn(const Map& map, PatchId query,
                                                      std::span<const PlaceCandidate> places,
                                                      const PlaceCandidateOptions& options) {
  std::map<IslandId, std::vector<PlaceCandidate>> islands;
  for (const PlaceCandidate& place : places) islands[map.graph().island(place.anchor)].push_back(place);
  std::vector<PlaceCandidate> taken;
  if (islands.empty()) return taken;
  auto island = std::next(islands.begin(), query.value % static_cast<std::ptrdiff_t>(islands.size()));
  for (std::size_t i = 0; i < islands.size(); ++i) {
    if (!taken.empty() && taken.size() + island->second.size() > options.max_places) break;
    std::ranges::copy(island->second, std::back_inserter(taken));
    if (++island == islands.end()) island = islands.begin();
  }
  return taken;
}

}  // namespace isthmus
