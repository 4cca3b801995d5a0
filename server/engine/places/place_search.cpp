#include "server/engine/places/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "scanmatch/match_relations.hpp"
#include "server/engine/map/contradiction.hpp"

namespace isthmus {
namespace {

constexpr double place_radius_m = 8;
constexpr std::size_t most_place_patches = 30;
constexpr double thin_m = 0.15;
constexpr double apart_m = 1;  // what counts as another answer
constexpr double apart_rad = 0.26;
constexpr double piece_reach_m = 14;
constexpr double least_refined_score = 0.45;
constexpr double least_bent_score = 0.33;   // of the whole, where one scan of it
constexpr double sure_scan_score = 0.6;     // fits so well
constexpr double most_contradiction = 0.2;  // before the trial has laid the two together
constexpr double bent_kernel_m = 0.08;      // some metres of way are not quite rigid
constexpr int most_points = 250;
constexpr std::size_t most_carriers = 4;

struct Cell {
  int x = 0;
  int y = 0;
  std::size_t index = 0;
  auto operator<=>(const Cell&) const = default;
};

// One point for each cell that has any: the first.
std::vector<ScanPoint> thinned(const LocalMap& local) {
  std::vector<ScanPoint> points;
  for (const LocalPatch& patch : local.patches)
    for (const ScanPoint& point : patch.patch->points)
      points.push_back({patch.local_from_patch * point.position,
                        rotate(patch.local_from_patch.yaw, point.normal), point.beam});
  std::vector<Cell> cells;
  cells.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& p = points[i].position;
    cells.push_back(
        {static_cast<int>(std::floor(p.x() / thin_m)), static_cast<int>(std::floor(p.y() / thin_m)), i});
  }
  std::ranges::sort(cells);
  std::vector<ScanPoint> kept;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (i == 0 || std::tie(cells[i].x, cells[i].y) != std::tie(cells[i - 1].x, cells[i - 1].y))
      kept.push_back(points[cells[i].index]);
  return kept;
}

std::vector<Eigen::Vector2d> positions(const std::vector<ScanPoint>& points) {
  std::vector<Eigen::Vector2d> positions;
  positions.reserve(points.size());
  for (const ScanPoint& point : points) positions.push_back(point.position);
  return positions;
}

CorrelativeOptions coarse_options(double least_score) {
  CorrelativeOptions options;
  options.cell_m = 0.2;
  options.yaw_step_rad = 0.035;
  options.blur_m = 0.2;
  options.reach_m = piece_reach_m;
  options.max_points = 90;
  options.apart_m = apart_m;
  options.apart_rad = apart_rad;
  options.least_score = least_score;
  options.max_evaluations = 60'000;
  return options;
}

CorrelativeOptions fine_options() {
  CorrelativeOptions options;
  options.reach_m = piece_reach_m;
  options.max_points = most_points;
  options.apart_m = apart_m;
  options.apart_rad = apart_rad;
  options.second_share = 0.95;
  return options;
}

double mean_contradiction(const RigidPiece& place, const RigidPiece& piece, const Pose& place_from_piece) {
  MeanContradiction found;
  for (const LocalPatch& seen : piece.local.patches)
    for (const LocalPatch& known : place.local.patches)
      found.add(*known.patch, *seen.patch,
                ominus(place_from_piece * seen.local_from_patch, known.local_from_patch));
  return found.mean(1);
}

Match match_at(const RigidPiece& place, std::span<const ScanPoint> points, const Pose& place_from_points,
               const MatchOptions& options) {
  const Eigen::Vector3d weak(1 / 0.25, 1 / 0.25, 1 / 0.01);
  return match_scan(place.local, points, {place_from_points, weak.asDiagonal()}, options);
}

}  // namespace

RigidPiece place_around(const Map& map, PatchId anchor, const EngineOptions& options) {
  Surroundings surroundings;
  surroundings.update(map, anchor, options, Surroundings::By::scans);
  std::vector<const Determined*> near;
  for (const Determined& determined : surroundings.patches())
    if (determined.firm &&
        std::hypot(determined.local_from_patch.x, determined.local_from_patch.y) < place_radius_m)
      near.push_back(&determined);
  RigidPiece place;
  place.local.reference = anchor;
  // Spread evenly over those there are, the anchor among them.
  const std::size_t stride = (near.size() + most_place_patches - 1) / most_place_patches;
  for (std::size_t i = 0; i < near.size(); i += std::max<std::size_t>(1, stride))
    place.local.patches.push_back({map.manifold().shared_patch(near[i]->patch), near[i]->local_from_patch});
  place.points = thinned(place.local);
  return place;
}

RigidPiece piece_of_way(const Map& map, std::span<const PatchId> newest_first) {
  RigidPiece piece;
  piece.local.reference = newest_first.front();
  const Pose& map_from_newest = map.manifold().pose(newest_first.front());
  for (const PatchId id : newest_first)
    piece.local.patches.push_back(
        {map.manifold().shared_patch(id), ominus(map.manifold().pose(id), map_from_newest)});
  piece.points = thinned(piece.local);
  return piece;
}

PlaceSearch search_place(const RigidPiece& place, const RigidPiece& piece, const SearchWindow& window,
                         double least_score) {
  PlaceSearch found;
  const std::vector<Eigen::Vector2d> known = positions(place.points);
  const CorrelativeResult coarse = search_window(known, piece.points, window, coarse_options(least_score));
  found.exhausted = coarse.exhausted;
  found.evaluations = coarse.evaluations;
  std::vector<Pose> starts;
  if (coarse.score > 0) starts.push_back(coarse.local_from_robot);
  if (coarse.second_score > 0) starts.push_back(coarse.second_local_from_robot);
  for (const Pose& start : starts) {
    const CorrelativeResult fine =
        search_window(known, piece.points, {start, 0.3, 0.3, 0.06}, fine_options());
    found.evaluations += fine.evaluations;
    if (fine.score >= least_score)
      found.answers.push_back({place.local.reference, fine.local_from_robot, fine.score, 0, 0});
  }
  std::ranges::stable_sort(found.answers, std::ranges::greater{}, &PlaceAnswer::score);
  return found;
}

bool is_unique(const Map& map, const std::vector<PlaceAnswer>& best_first) {
  const PlaceAnswer& best = best_first.front();
  const Pose best_map_from_piece = map.manifold().pose(best.anchor) * best.anchor_from_piece;
  return std::ranges::none_of(best_first, [&](const PlaceAnswer& other) {
    if (other.score < ambiguous_share * best.score) return false;
    if (map.graph().island(other.anchor) != map.graph().island(best.anchor)) return true;
    const Pose off = ominus(map.manifold().pose(other.anchor) * other.anchor_from_piece, best_map_from_piece);
    return std::hypot(off.x, off.y) > apart_m || std::abs(off.yaw) > apart_rad;
  });
}

std::optional<Find> refine(const RigidPiece& place, const RigidPiece& piece, const PlaceAnswer& answer,
                           const EngineOptions& options) {
  MatchOptions match_options = options.match;
  match_options.max_points = most_points;
  match_options.kernel_m = bent_kernel_m;
  const Match whole = match_at(place, piece.points, answer.anchor_from_piece, match_options);
  if (!whole.ok || whole.quality.degenerate || whole.quality.score < least_bent_score) return std::nullopt;
  if (mean_contradiction(place, piece, whole.local_from_robot) > most_contradiction) return std::nullopt;
  // The newest patches may look where the place does not reach: the one that fits best carries the relations.
  std::optional<Match> best;
  const LocalPatch* carrier = nullptr;
  for (std::size_t i = 0; i < std::min(most_carriers, piece.local.patches.size()); ++i) {
    const LocalPatch& seen = piece.local.patches[i];
    Match match =
        match_at(place, seen.patch->points, whole.local_from_robot * seen.local_from_patch, options.match);
    if (!match.ok || match.quality.degenerate || match.quality.score < least_refined_score) continue;
    if (best && match.quality.score <= best->quality.score) continue;
    best = std::move(match);
    carrier = &seen;
  }
  if (!best || (whole.quality.score < least_refined_score && best->quality.score < sure_scan_score))
    return std::nullopt;
  Find find;
  find.query = carrier->patch->id;
  find.anchor = answer.anchor;
  find.anchor_from_query = best->local_from_robot;
  find.way_m = answer.way_m;
  find.sigma_m = answer.sigma_m;
  find.score = whole.quality.score;
  find.relations = match_relations(place.local, carrier->patch->points, *best, find.query,
                                   {OriginKind::hypothesis, {}}, options.relations);
  if (find.relations.empty()) return std::nullopt;
  return find;
}

}  // namespace isthmus
