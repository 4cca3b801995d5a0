#pragma once

#include "scanmatch/features/scan_features.hpp"
#include "server/engine/input/engine_options.hpp"
#include "server/feature_maps/meeting/clue.hpp"
#include "server/feature_maps/meeting/twins.hpp"
#include "server/feature_maps/merging/merging_options.hpp"
#include "server/feature_maps/tracking/tracking_options.hpp"
#include "server/features/fusion/fusion.hpp"
#include "server/features/options.hpp"

namespace isthmus {

/// What a map is made of.
enum class FeatureMapKind {
  segments,  ///< walls in scans; robots come together where they see one another
  points     ///< fixed barcodes, known by their numbers; robots come together where they know the same ones
};

struct FeatureMapOptions {
  FeatureMapKind kind = FeatureMapKind::segments;
  bool any_tag = false;  ///< a barcode that nobody wears is fixed in the building
  FilterOptions filter;
  ScanFeatureOptions scan_features;
  FusionOptions fusion;
  EngineOptions engine;             ///< of odometry's noise, and of scan tracking
  TrackingOptions tracking;         ///< what scans are placed on
  double observe_every_m = 0.1;     ///< m driven between scans that are used: a step costs n²
  double observe_every_rad = 0.02;  ///< rad turned between them
  double wait_s = 0.2;              ///< of event time that scans and sightings wait for odometry
  double encounter_s = 2;  ///< within which two robots see one another once: what errs then errs together
  double target_speed_m_s = 0.5;  ///< at which a robot that is seen may drive while its odometry is not known
  PlacementOptions placement;
  double fusion_log_odds = 7;          ///< from which maps become one: one wrong in a thousand
  double clues_suffice_log_odds = 20;  ///< from which nobody counts twins at other places: that takes long
  std::size_t max_clues = 40;          ///< between two maps; further ones take the place of the oldest
  TwinOptions twins;
  MergingOptions merging;               ///< of maps of segments, without a sighting
  double sighting_probability = 0.999;  ///< that a true sighting passes its gate
  std::size_t min_landmarks = 3;        ///< known to both maps, by which two maps of points come together
  double repeat_s = 0.5;                ///< s within which sightings of one barcode err alike: one counts
};

/// Those of a kind. Walls shorter than a metre and rough by 2 cm are left out or allowed for: they are seen
/// in too many ways, and wrong pairings with them cost more than they tell. Odometry is taken to err two to
/// three times as the engine first thinks, for a filter cannot take back what it believed.
FeatureMapOptions feature_map_options(FeatureMapKind kind);

}  // namespace isthmus
