#include "server/engine/places/place_search.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "scanmatch/match_relations.hpp"
#include "scanmatch/score_profile.hpp"
#include "server/engine/map/in_view.hpp"

namespace isthmus {
namespace {

struct Cell {
  std::uint64_t place = 0;  ///< column, then row: to be sorted by, as fast as numbers are
  std::size_t index = 0;
  auto operator<=>(const Cell&) const = default;

  static std::uint64_t place_of(const Eigen::Vector2d& position, double cell_m) {
    const auto number = [&](double at) {
      return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(at / cell_m))) ^ 0x8000'0000U;
    };
    return std::uint64_t{number(position.x())} << 32U | number(position.y());
  }
};

CorrelativeOptions in_place(const CorrelativeOptions& correlative, const PlaceSearchOptions& options) {
  CorrelativeOptions search = correlative;
  search.apart_m = options.common.apart_m;
  search.apart_rad = options.common.yaw_rad(options.common.apart_m);
  return search;
}

CorrelativeOptions fine_options(const EngineOptions& options) {
  CorrelativeOptions fine = in_place(options.correlative, options.place_search);
  fine.max_points = options.match.max_points;
  fine.second_share = options.place_search.fine_second_share;
  return fine;
}

Match match_at(const RigidPiece& place, std::span<const ScanPoint> points, const Pose& place_from_points,
               const MatchOptions& match_options, const EngineOptions& options) {
  // As far off as what the search takes for the same answer.
  const double off_m = options.correlative.apart_m;
  const Eigen::Vector3d weak =
      Eigen::Vector3d(off_m, off_m, options.common.yaw_rad(off_m)).cwiseAbs2().cwiseInverse();
  return match_scan(place.local, points, {place_from_points, weak.asDiagonal()}, match_options);
}

/// The scan of a patch of the way that says in full where the way lies.
struct Carrier {
  const Patch* patch = nullptr;
  Pose piece_from_patch;
  Match match;
};

// How far the scan may be off along the direction that few of its beams hold; what is farther off than the
// profile looks would be another answer of the search.
bool holds_all_directions(const RigidPiece& place, Carrier& carrier, const EngineOptions& options) {
  const double weak_sigma_m =
      sigma_along_weak_direction(place.local, carrier.patch->points, carrier.match, options.common.apart_m,
                                 options.match, options.weak_direction);
  believe_profile(carrier.match, weak_sigma_m, relation_sigma_m(carrier.match.quality, options.relations),
                  options.match, options.weak_direction);
  return weak_sigma_m < options.place_search.max_weak_sigma_m;
}

// The newest patches may look where the place does not reach, or along a bare corridor: the one that fits
// best of those that hold all directions.
std::optional<Carrier> best_carrier(const RigidPiece& place, const RigidPiece& piece,
                                    const Pose& place_from_piece, double min_score,
                                    const EngineOptions& options) {
  const PlaceSearchOptions& its = options.place_search;
  std::vector<Carrier> carriers;
  for (std::size_t i = 0; i < std::min(its.max_carriers, piece.local.patches.size()); ++i) {
    const LocalPatch& seen = piece.local.patches[i];
    Match match =
        match_at(place, seen.patch->points, place_from_piece * seen.local_from_patch, options.match, options);
    if (match.ok && match.quality.score >= min_score)
      carriers.push_back({seen.patch.get(), seen.local_from_patch, std::move(match)});
  }
  std::ranges::stable_sort(carriers, std::ranges::greater{},
                           [](const Carrier& carrier) { return carrier.match.quality.score; });
  for (Carrier& carrier : carriers)
    if (holds_all_directions(place, carrier, options)) return std::move(carrier);
  return std::nullopt;
}

bool is_of_place(const Determined& determined, const PlaceSearchOptions& options) {
  return determined.well_determined &&
         std::hypot(determined.local_from_patch.x, determined.local_from_patch.y) < options.place_radius_m;
}

double log_odds_of(const Find& find, const FindEvidenceOptions& options) {
  const double speaks_for_it = options.per_search_score * find.search_score +
                               options.per_carrier_score * find.carrier_score +
                               options.per_seen_again * find.seen_again;
  return speaks_for_it - options.against_no_score - (find.way_m > 0 ? 0 : options.against_anywhere);
}

}  // namespace

std::vector<ScanPoint> thinned_points(const LocalMap& local, double cell_m) {
  std::vector<ScanPoint> points;
  for (const LocalPatch& patch : local.patches) {
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(patch.local_from_patch.yaw).toRotationMatrix();
    const Eigen::Vector2d origin = position(patch.local_from_patch);
    for (const ScanPoint& point : patch.patch->points)
      points.push_back({turn * point.position + origin, turn * point.normal, point.beam});
  }
  std::vector<Cell> cells;
  cells.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    cells.push_back({Cell::place_of(points[i].position, cell_m), i});
  std::ranges::sort(cells);
  std::vector<ScanPoint> kept;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (i == 0 || cells[i].place != cells[i - 1].place) kept.push_back(points[cells[i].index]);
  return kept;
}

std::vector<Eigen::Vector2d> positions(std::span<const ScanPoint> points) {
  std::vector<Eigen::Vector2d> positions;
  positions.reserve(points.size());
  for (const ScanPoint& point : points) positions.push_back(point.position);
  return positions;
}

CorrelativeOptions coarse_search(const EngineOptions& options) {
  CorrelativeOptions coarse = in_place(options.correlative, options.place_search);
  coarse.cell_m *= options.place_search.coarse;
  coarse.yaw_step_rad *= options.place_search.coarse;
  coarse.blur_m *= options.place_search.coarse;
  coarse.max_evaluations = options.place_search.coarse_evaluations;
  return coarse;
}

std::vector<PatchId> own_part(const Map& map, const RigidPiece& piece) {
  std::vector<PatchId> own;
  for (const LocalPatch& local : piece.local.patches) {
    own.push_back(local.patch->id);
    std::ranges::copy(map.graph().neighbours(local.patch->id), std::back_inserter(own));
  }
  std::ranges::sort(own);
  own.erase(std::unique(own.begin(), own.end()), own.end());
  return own;
}

RigidPiece place_around(const Map& map, PatchId anchor, std::span<const PatchId> without,
                        const EngineOptions& options) {
  Surroundings surroundings;
  surroundings.update(map, anchor, options, Surroundings::By::scans);
  return place_of(map, surroundings, without, options.place_search);
}

RigidPiece place_of(const Map& map, const Surroundings& surroundings, std::span<const PatchId> without,
                    const PlaceSearchOptions& options) {
  std::vector<const Determined*> near;
  for (const Determined& determined : surroundings.patches())
    if (is_of_place(determined, options) && !std::ranges::binary_search(without, determined.patch))
      near.push_back(&determined);
  RigidPiece place;
  place.local.reference = surroundings.reference();
  // Spread evenly over those there are.
  const std::size_t stride = (near.size() + options.max_place_patches - 1) / options.max_place_patches;
  for (std::size_t i = 0; i < near.size(); i += std::max<std::size_t>(1, stride))
    place.local.patches.push_back({map.manifold().shared_patch(near[i]->patch), near[i]->local_from_patch});
  place.points = thinned_points(place.local, options.thin_m);
  return place;
}

std::vector<PatchId> patches_of_place(const Surroundings& surroundings, const PlaceSearchOptions& options) {
  std::vector<PatchId> patches;
  for (const Determined& determined : surroundings.patches())
    if (is_of_place(determined, options)) patches.push_back(determined.patch);
  return patches;
}

RigidPiece piece_of_way(const Map& map, std::span<const PatchId> newest_first,
                        const PlaceSearchOptions& options) {
  RigidPiece piece;
  piece.local.reference = newest_first.front();
  const Pose& map_from_newest = map.manifold().pose(newest_first.front());
  for (const PatchId id : newest_first)
    piece.local.patches.push_back(
        {map.manifold().shared_patch(id), ominus(map.manifold().pose(id), map_from_newest)});
  piece.points = thinned_points(piece.local, options.thin_m);
  return piece;
}

PlaceSearch search_place(const RigidPiece& place, const RigidPiece& piece, const SearchWindow& window,
                         double min_score, const EngineOptions& options) {
  PlaceSearch found;
  const std::vector<Eigen::Vector2d> known = positions(place.points);
  const CorrelativeResult coarse =
      search_window(known, piece.points, window, coarse_search(options), min_score);
  found.exhausted = coarse.exhausted;
  found.evaluations = coarse.evaluations;
  // What a coarse step is off by and a fine one.
  const CorrelativeOptions fine_search = fine_options(options);
  const double steps = 1 + options.place_search.coarse;
  const double half_m = steps * fine_search.cell_m, half_rad = steps * fine_search.yaw_step_rad;
  std::vector<Pose> starts;
  if (coarse.score > 0) starts.push_back(coarse.local_from_robot);
  if (coarse.second_score > 0) starts.push_back(coarse.second_local_from_robot);
  for (const Pose& start : starts) {
    const SearchWindow about{start, half_m, half_m, half_rad};
    const CorrelativeResult fine = search_window(known, piece.points, about, fine_search);
    found.evaluations += fine.evaluations;
    if (fine.score >= min_score)
      found.answers.push_back({place.local.reference, fine.local_from_robot, fine.score, 0, 0});
  }
  std::ranges::stable_sort(found.answers, std::ranges::greater{}, &PlaceAnswer::score);
  return found;
}

int look_alikes(const Map& map, const std::vector<PlaceAnswer>& best_first, const EngineOptions& options) {
  const Manifold& manifold = map.manifold();
  const auto apart = [&](const PlaceAnswer& one, const PlaceAnswer& other) {
    if (map.graph().island(one.anchor) != map.graph().island(other.anchor)) return true;
    const Pose off = ominus(manifold.pose(other.anchor) * other.anchor_from_piece,
                            manifold.pose(one.anchor) * one.anchor_from_piece);
    return !options.common.is_within(off, options.common.apart_m);
  };
  std::vector<PlaceAnswer> places;
  for (const PlaceAnswer& answer : best_first) {
    if (answer.score < options.ambiguity.share * best_first.front().score) continue;
    if (std::ranges::all_of(places, [&](const PlaceAnswer& place) { return apart(place, answer); }))
      places.push_back(answer);
  }
  return static_cast<int>(places.size());
}

double seen_again(const RigidPiece& place, const RigidPiece& piece, const Pose& place_from_piece,
                  const ContradictionOptions& options) {
  return in_view(place.local, piece.points, place_from_piece, options).share_seen() *
         in_view(piece.local, place.points, inverse(place_from_piece), options).share_seen();
}

double Find::probability() const { return 1 / (1 + std::exp(-log_odds)); }

std::optional<Find> refine(const RigidPiece& place, const RigidPiece& piece, const PlaceAnswer& answer,
                           double min_carrier_score, const EngineOptions& options) {
  MatchOptions match_options = options.match;
  match_options.kernel_m = options.weak_direction.start_kernels * options.match.kernel_m;
  const Match whole = match_at(place, piece.points, answer.anchor_from_piece, match_options, options);
  if (!whole.ok) return std::nullopt;
  const std::optional<Carrier> best =
      best_carrier(place, piece, whole.local_from_robot, min_carrier_score, options);
  if (!best) return std::nullopt;
  Find find;
  find.query = best->patch->id;
  find.anchor = answer.anchor;
  find.anchor_from_query = best->match.local_from_robot;
  find.way_m = answer.way_m;
  find.sigma_m = answer.sigma_m;
  find.search_score = answer.score;
  find.carrier_score = best->match.quality.score;
  find.seen_again = seen_again(place, piece, best->match.local_from_robot * inverse(best->piece_from_patch),
                               options.contradiction);
  find.log_odds = log_odds_of(find, options.find_evidence);
  find.relations = match_relations(place.local, best->patch->points, best->match, find.query,
                                   {OriginKind::hypothesis, {}}, options.relations);
  if (find.relations.empty()) return std::nullopt;
  return find;
}

}  // namespace isthmus
