#include "server/engine/places/place_survey.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "scanmatch/fit_survey.hpp"

namespace isthmus {
namespace {

constexpr double max_cells = 4e6;  // of a grid: 400 m x 400 m in cells of 0.2 m

struct Box {
  Eigen::Vector2d low;
  Eigen::Vector2d high;

  void take_in(const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

// Nothing: it is too wide.
std::optional<FitSurvey> survey_of(const Map& map, IslandId island, const CorrelativeOptions& search,
                                   const EngineOptions& options) {
  const Manifold& manifold = map.manifold();
  LocalMap whole;
  Box box{position(manifold.pose(island)), position(manifold.pose(island))};
  for (const PatchId id : map.graph().patches_of(island)) {
    whole.patches.push_back({manifold.shared_patch(id), manifold.pose(id)});
    box.take_in(position(manifold.pose(id)));
  }
  const PlaceCandidateOptions& its = options.place_candidates;
  const Eigen::Vector2d window = Eigen::Vector2d::Constant(2 * (its.spacing_m + its.window_margin_m));
  const Eigen::Array2d side_m = (box.high - box.low + 2 * window).array() + 2 * search.reach_m;
  if (side_m.prod() > max_cells * search.cell_m * search.cell_m) return std::nullopt;
  return FitSurvey(positions(thinned_points(whole, options.place_search.thin_m)), box.low - window,
                   box.high + window, search);
}

// A grid need reach no farther than beams do.
CorrelativeOptions search_for(std::span<const RigidPiece> pieces, const EngineOptions& options) {
  CorrelativeOptions search = coarse_search(options);
  double reach_m = 0;
  for (const RigidPiece& piece : pieces)
    reach_m = std::max(reach_m, reach_of(searched_beams(piece.points, search), search));
  search.reach_m = reach_m;
  return search;
}

struct PlaceOfPiece {
  std::size_t piece = 0;
  PlaceCandidate* place = nullptr;
};

}  // namespace

// Island by island, and piece by piece: one grid is held at a time, and one scan on it.
void leave_possible(std::vector<std::vector<PlaceCandidate>>& places_by_piece,
                    std::span<const RigidPiece> pieces, const Map& map, double min_score,
                    const EngineOptions& options) {
  std::map<IslandId, std::vector<PlaceOfPiece>> islands;
  for (std::size_t i = 0; i < places_by_piece.size(); ++i)
    for (PlaceCandidate& place : places_by_piece[i])
      if (place.is_on_other_island()) islands[map.graph().island(place.anchor)].push_back({i, &place});
  if (islands.empty()) return;
  const CorrelativeOptions search = search_for(pieces, options);
  for (const auto& [island, places] : islands) {
    const std::optional<FitSurvey> survey = survey_of(map, island, search, options);
    if (!survey) continue;
    std::optional<SurveyedScan> scan;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto& [piece, place] = places[i];
      if (i == 0 || places[i - 1].piece != piece)
        scan.emplace(*survey, pieces[piece].points, min_score, search);
      if (!scan->may_fit(map.manifold().pose(place->anchor), place->window)) place->anchor = {};
    }
  }
  for (std::vector<PlaceCandidate>& places : places_by_piece)
    std::erase_if(places, [](const PlaceCandidate& place) { return !place.anchor.valid(); });
}

}  // namespace isthmus
