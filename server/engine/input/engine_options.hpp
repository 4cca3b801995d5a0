#pragma once

#include "patches/patch.hpp"
#include "relations/confidence.hpp"
#include "scanmatch/match.hpp"
#include "scanmatch/match_relations.hpp"

namespace isthmus {

/// The engine's settings. Defaults serve every log and building; the configuration file offers the first few.
struct EngineOptions {
  /// Eq. 12: how well a patch must be determined relative to the robot's, to be in its local map.
  ConfidenceThreshold local_map = {0.25, 0.2};
  /// A scan farther than this from every patch of the local map becomes a patch.
  double patch_spacing_m = 1.0;
  double patch_spacing_rad = 0.7;
  /// A scan with more than this share of its free space outside the local map becomes a patch.
  double uncovered_share = 0.3;
  /// A robot adds no more: it is localised in the map that there is.
  std::size_t patches_per_robot = 20'000;

  /// One near another but turned away from it, by more than patch_spacing_rad, with more than this share
  /// outside.
  double turned_uncovered_share = 0.05;

  PatchOptions patch;

  /// Patches beyond eq. 12 but determined so well are where a local loop may close (rejoin.hpp).
  ConfidenceThreshold rejoin = {8, 0.6};
  std::size_t confidence_patches = 150;  ///< eq. 12 looks at so many patches, nearest in the graph
  std::size_t rejoin_patches = 400;      ///< and the search for local loops at so many
  double local_map_reach_m = 4;          ///< patches with origins farther away are left out
  double local_map_overlap = 0.3;        ///< and those that a scan overlaps less than this
  int local_map_oldest = 8;
  int local_map_newest = 4;

  MatchOptions match;
  double match_score = 0.25;    ///< a match below this is not believed
  double restart_score = 0.45;  ///< nor one far from where odometry put the robot, below this
  double turned_score = 0.85;   ///< nor is one turned away from its neighbours on known ground, below this
  double found_score = 0.6;     ///< nor one after odometry did what no robot does, below this
  double thin_score = 0.5;      ///< a match below this is on new ground: worth a patch
  /// Factor on a match's information against odometry's, from scan to scan: a match with many patches errs
  /// less than the nominal noise of its beams, odometry more than its steps say.
  double match_trust = 5;
  MatchRelationOptions relations;
  std::size_t window_patches = 40;  ///< fitted when a patch is added
  std::size_t loop_patches = 150;   ///< fitted at once when a local loop closes; the island follows
};

}  // namespace isthmus
