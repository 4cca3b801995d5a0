#pragma once

#include "patches/patch.hpp"
#include "relations/confidence.hpp"
#include "scanmatch/correlative.hpp"
#include "scanmatch/match.hpp"
#include "scanmatch/match_relations.hpp"
#include "scanmatch/score_profile.hpp"
#include "server/engine/input/options/closure_options.hpp"
#include "server/engine/input/options/common_options.hpp"
#include "server/engine/input/options/frozen_options.hpp"
#include "server/engine/input/options/hypothesis_options.hpp"
#include "server/engine/input/options/intake_options.hpp"
#include "server/engine/input/options/localise_options.hpp"
#include "server/engine/input/options/map_options.hpp"
#include "server/engine/input/options/place_options.hpp"
#include "server/engine/input/options/propagation_options.hpp"
#include "server/engine/input/options/record_options.hpp"
#include "server/engine/input/options/rendezvous_options.hpp"
#include "server/engine/input/options/robot_options.hpp"
#include "server/engine/input/options/sighting_options.hpp"

namespace isthmus {

/// The engine's settings, with defaults that serve every log. The first few are offered to users, by [engine]
/// and [limits] of the configuration.
///
/// The rest, each number that decides something about the map, stands in one struct of its room: a field with
/// its default, and once in `visit_options` with its name, unit and meaning. Where no other reason or source
/// is given there, a value was chosen on the recorded logs intel, aces and fr079, and nothing says that it
/// carries to other buildings. They are for experiments: [tuning] of the configuration sets them, and
/// `isthmus-replay --list-tuning` lists them, both by `visit_tuning`, so that there is no second list. What
/// decides nothing about the map (bounds on memory, formats, guards of arithmetic) stays where it is used.
struct EngineOptions {
  /// Eq. 12: how well a patch must be determined relative to the robot's, to be in its local map.
  ConfidenceThreshold local_map = {0.25, 0.2};
  /// A scan farther than this from every patch of the local map becomes a patch.
  double patch_spacing_m = 1.0;
  double patch_spacing_rad = 0.7;
  /// A scan with more than this share of its free space outside the local map becomes a patch.
  double uncovered_share = 0.22;
  /// Maximum of one robot; from then on it is only localised.
  std::size_t patches_per_robot = 20'000;
  PatchOptions patch;

  CommonOptions common;
  MatchOptions match;
  MatchRelationOptions relations;
  WeakDirectionOptions weak_direction;
  CorrelativeOptions correlative;
  AmbiguityOptions ambiguity;
  SurroundingsOptions surroundings;
  LocalLoopOptions local_loops;
  ContradictionOptions contradiction;
  MapFitOptions map_fit;
  WeakLinkOptions weak_links;
  LocaliseOptions localise;
  FollowOptions follow;
  ExtendOptions extend;
  FootprintOptions footprints;
  OdometryNoiseOptions odometry_noise;
  OdometryBiasOptions odometry_bias;
  OdometryLearningOptions odometry_learning;
  UsualMisfitOptions usual_misfit;
  ScanDelayOptions scan_delay;
  PoseHistoryOptions pose_history;
  TeammateOptions teammates;
  HealthOptions health;
  HealthWarningOptions health_warnings;
  PropagationOptions propagation;
  SharedPartOptions shared_part;
  TrialOptions trial;
  PlaceCandidateOptions place_candidates;
  PlaceSearchOptions place_search;
  FindEvidenceOptions find_evidence;
  AnswersAlongWayOptions answers_along_way;
  ConsistencyOptions consistency;
  AlignmentOptions alignment;
  EvidenceOptions evidence;
  ClosureOptions closures;
  HypothesisOptions hypotheses;
  IntakeOptions intake;
  FinderOptions finder;
  FrozenOptions frozen;
  MeetingOptions meeting;
  RendezvousOptions rendezvous;
  RefinementOptions refinement;

  /// Calls `group(name, struct)` for each.
  template <class Visitor>
  void visit_tuning(Visitor&& group) {
    group("normals", patch.normals);
    group("outline", patch.free_space.outline);
    group("common", common);
    group("match", match);
    group("relations", relations);
    group("weak_direction", weak_direction);
    group("correlative", correlative);
    group("ambiguity", ambiguity);
    group("surroundings", surroundings);
    group("local_loops", local_loops);
    group("contradiction", contradiction);
    group("map_fit", map_fit);
    group("weak_links", weak_links);
    group("localise", localise);
    group("follow", follow);
    group("extend", extend);
    group("footprints", footprints);
    group("odometry_noise", odometry_noise);
    group("odometry_bias", odometry_bias);
    group("odometry_learning", odometry_learning);
    group("usual_misfit", usual_misfit);
    group("scan_delay", scan_delay);
    visit_team_tuning(group);
  }

  /// Brings the copies of `common` up to date after it was changed.
  void share_common() {
    visit_tuning([this](const char*, auto& group) {
      if constexpr (requires { group.common; }) group.common = common;
    });
  }

  /// The groups of what is between robots, and of what is done with a map.
  template <class Visitor>
  void visit_team_tuning(Visitor&& group) {
    group("pose_history", pose_history);
    group("teammates", teammates);
    group("health", health);
    group("health_warnings", health_warnings);
    group("propagation", propagation);
    group("shared_part", shared_part);
    group("trial", trial);
    group("place_candidates", place_candidates);
    group("place_search", place_search);
    group("find_evidence", find_evidence);
    group("answers_along_way", answers_along_way);
    group("consistency", consistency);
    group("alignment", alignment);
    group("evidence", evidence);
    group("closures", closures);
    group("hypotheses", hypotheses);
    group("intake", intake);
    group("finder", finder);
    group("frozen", frozen);
    group("meeting", meeting);
    group("rendezvous", rendezvous);
    group("refinement", refinement);
  }
};

}  // namespace isthmus
