#pragma once

#include <optional>
#include <tuple>
#include <vector>

#include "scanmatch/correlative.hpp"
#include "server/engine/map/surroundings.hpp"

namespace isthmus {

/// A piece of the map taken as rigid: patches around one, in its frame, with their points thinned.
struct RigidPiece {
  LocalMap local;
  std::vector<ScanPoint> points;

  auto members() { return std::tie(local, points); }
};

/// Points of a local map in its frame, one for each cell that has any: the first; and where they lie.
std::vector<ScanPoint> thinned_points(const LocalMap& local, double cell_m);
std::vector<Eigen::Vector2d> positions(std::span<const ScanPoint> points);

/// A place to search: a patch with what is well determined relative to it nearby, but for some patches (by
/// id).
RigidPiece place_around(const Map& map, PatchId anchor, std::span<const PatchId> without,
                        const EngineOptions& options);
/// The same, where the surroundings (by scans) are known; and which patches it is chosen from.
RigidPiece place_of(const Map& map, const Surroundings& surroundings, std::span<const PatchId> without,
                    const PlaceSearchOptions& options);
std::vector<PatchId> patches_of_place(const Surroundings& surroundings, const PlaceSearchOptions& options);

/// What a robot saw on the last metres of its way, as seen from the newest of its patches there.
RigidPiece piece_of_way(const Map& map, std::span<const PatchId> newest_first,
                        const PlaceSearchOptions& options);

/// The patches of a piece and those that were matched with them, by id: where they lie is what is asked, so
/// they are no place to find the piece at.
std::vector<PatchId> own_part(const Map& map, const RigidPiece& piece);

/// Where a piece of a robot's way could lie at a place.
struct PlaceAnswer {
  PatchId anchor;
  Pose anchor_from_piece;
  double score = 0;
  double way_m = 0;  ///< between the two over the map, and how surely (see PlaceCandidate)
  double sigma_m = 0;

  auto members() { return std::tie(anchor, anchor_from_piece, score, way_m, sigma_m); }
};

/// How a piece is first searched for, coarsely in the whole window.
CorrelativeOptions coarse_search(const EngineOptions& options);

/// The pose at which a piece fits a place best and, where there is one, the best well apart from it. Nothing
/// that fits worse than `min_score`. First coarsely in the whole window, then finely about what is found.
struct PlaceSearch {
  std::vector<PlaceAnswer> answers;  ///< best first
  bool exhausted = false;            ///< the cap on work was reached: what was found need not be the best
  long evaluations = 0;
};
PlaceSearch search_place(const RigidPiece& place, const RigidPiece& piece, const SearchWindow& window,
                         double min_score, const EngineOptions& options);

/// At how many places apart from one another answers fit not clearly worse than the best: 1 where that is the
/// only one.
int look_alikes(const Map& map, const std::vector<PlaceAnswer>& best_first, const EngineOptions& options);

/// Of what a piece and a place each had in view of the other, the shares that they saw too, multiplied. Ways
/// that cross or lead back show one another little, and all of that again.
double seen_again(const RigidPiece& place, const RigidPiece& piece, const Pose& place_from_piece,
                  const ContradictionOptions& options);

/// How a robot's patch lies at a place, as scans say in full.
struct Find {
  PatchId query;   ///< the robot's patch
  PatchId anchor;  ///< of the place
  Pose anchor_from_query;
  double way_m = 0;
  double sigma_m = 0;
  std::vector<Relation> relations;  ///< of patches of the way with patches of the place
  int look_alikes = 1;              ///< places that look alike: the way before it tells which
  double search_score = 0;
  double carrier_score = 0;  ///< of the match of the query's scan
  double seen_again = 0;     ///< see seen_again
  double log_odds = 0;       ///< that the piece was there, by these

  double probability() const;

  auto members() {
    return std::tie(query, anchor, anchor_from_query, way_m, sigma_m, relations, look_alikes, search_score,
                    carrier_score, seen_again, log_odds);
  }
};

/// Fits the piece to the place in full, and the scan of one of its patches for the relations. Nothing where
/// none of its scans fits by that score, or each leaves a direction open.
std::optional<Find> refine(const RigidPiece& place, const RigidPiece& piece, const PlaceAnswer& answer,
                           double min_carrier_score, const EngineOptions& options);

}  // namespace isthmus
