#pragma once

#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "relations/confidence.hpp"
#include "scanmatch/correlative.hpp"
#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/drift.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/map/ways.hpp"

namespace isthmus {

/// A place where a robot's newest patch might be, by what the map knows.
struct PlaceCandidate {
  PatchId anchor;
  SearchWindow window;  ///< of the patch in the anchor's frame
  double way_m = 0;     ///< between the two over the map; 0: on another island
  /// How surely the map has the patch there, in all; infinite on another island.
  double sigma_m = std::numeric_limits<double>::infinity();

  bool is_on_other_island() const { return way_m <= 0; }

  auto members() { return std::tie(anchor, window, way_m, sigma_m); }
};

/// Where a patch lies if a find that waits is true: what was found a few metres ago says where to look now.
struct PlaceHint {
  IslandId island;
  Pose island_from_patch;
  double drift_m = 0;  ///< that the way since then may have made of it

  auto members() { return std::tie(island, island_from_patch, drift_m); }
};

/// A piece of a robot's way whose places are asked for, with what waiting finds say of its newest patch.
struct PlaceQuestion {
  std::vector<PatchId> newest_first;
  std::vector<PlaceHint> hints;
  std::vector<std::string> not_of;  ///< by name: robots on whose patches it does not lie
  bool on_other_islands = true;     ///< as well as on its own,
  bool in_turn = false;             ///< on some of them (places_on_islands_in_turn)
};

/// Places of the patch's own island that are far from it over the map's relations, but whose projection could
/// come to lie on it within the relative covariance. Those so well determined that a find could only be what
/// the map says are left out: local loops are for local_loop.hpp. First those that hints name, then the
/// likeliest; where there are more than are searched at once, others in turn from patch to patch. The network
/// and the covariances are those of the map and of the patch's island.
std::vector<PlaceCandidate> places_on_own_island(const Map& map, const PlaceQuestion& question,
                                                 const WayNetwork& network, const IslandCovariances& island,
                                                 const PlaceCandidateOptions& options);

/// Places of all other islands that are worth a name: nothing but hints says where on them the patch lies.
/// All of them; of large islands some, others in turn from patch to patch.
std::vector<PlaceCandidate> places_on_other_islands(const Map& map, PatchId query,
                                                    std::span<const PlaceHint> hints,
                                                    const PlaceCandidateOptions& options);

/// Of places on several islands those on as many of them as come to no more than are searched of one: what a
/// search costs does not grow with the number of islands then. Another island is first from patch to patch.
std::vector<PlaceCandidate> places_on_islands_in_turn(const Map& map, PatchId query,
                                                      std::span<const PlaceCandidate> places,
                                                      const PlaceCandidateOptions& options);

}  // namespace isthmus
