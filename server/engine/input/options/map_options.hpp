#pragma once

#include <cstddef>
#include <cstdint>

#include "patches/option_unit.hpp"
#include "relations/chi_squared.hpp"

namespace isthmus {

/// What belongs to a robot's surroundings and local map (eq. 12), see map/surroundings.hpp.
struct SurroundingsOptions {
  double loop_position_m = 8;
  double loop_yaw_rad = 0.6;
  std::size_t confidence_patches = 150;
  std::size_t loop_patches = 400;
  double reach_m = 4;
  double min_overlap = 0.3;
  int overlap_points = 30;
  int oldest = 8;
  int newest = 4;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(loop_position_m, "loop_position_m", "m",
           "95 % bound: patches beyond eq. 12, but determined so well, are where a local loop may close");
    option(loop_yaw_rad, "loop_yaw_rad", "rad", "the same bound of the yaw");
    option(confidence_patches, "confidence_patches", "count",
           "of patches, nearest in the graph, that eq. 12 looks at");
    option(loop_patches, "loop_patches", "count",
           "of patches, nearest in the graph, among which local loops are looked for");
    option(reach_m, "reach_m", "m", "patches with origins farther away are left out of the local map");
    option(min_overlap, "min_overlap", share_unit,
           "of the scan's points that have a point of the patch near them; patches with less are left out");
    option(overlap_points, "overlap_points", "count", "of the scan that this share is taken of");
    option(oldest, "oldest", "count", "of patches of the local map: the oldest hold the map together");
    option(newest, "newest", "count", "of patches of the local map that are the newest there");
  }
};

/// Local loops, see map/local_loop.hpp.
struct LocalLoopOptions {
  double min_score = 0.55;
  double min_score_partly_known = 0.6;
  double min_paired = 0.35;
  ChiSquaredBound max_surprise{0.999, 3};
  double unambiguous_half_width_m = 0.6;
  double max_window_m = 6;
  double max_window_rad = 0.7;
  double window_sigmas = 2.5;
  double slip_variance_m2 = 0.04;
  double slip_variance_rad2 = 1e-3;
  double prediction_share = 0.01;
  double looked_along_m = 0.6;
  std::size_t max_patches = 20;
  double agreeing_m = 0.4;
  double agreeing_rad = 0.07;
  int min_agreeing = 3;
  double min_way_m = 2;
  std::size_t max_waiting = 20;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(min_score, "min_score", share_unit, "score of a match, over all beams, that closes a local loop");
    option(min_score_partly_known, "min_score_partly_known", share_unit,
           "the same over the beams that found something to pair with, where the rest may look elsewhere");
    option(min_paired, "min_paired", share_unit, "of the beams that must then have found something");
    option(max_surprise, "max_surprise", "probability",
           "χ² of 3 of a match that ends away from where the map expected the robot");
    option(unambiguous_half_width_m, "unambiguous_half_width_m", "m",
           "a search window as narrow as this leaves nothing else that could be meant");
    option(max_window_m, "max_window_m", "m", "half width of the widest window that is searched at once");
    option(max_window_rad, "max_window_rad", "rad", "the same in yaw");
    option(window_sigmas, "window_sigmas", "sigmas", "half width of a window");
    option(slip_variance_m2, "slip_variance_m2", "m²",
           "added to the relative covariance: a slip of the past is in none, and here is the last chance to "
           "mend it");
    option(slip_variance_rad2, "slip_variance_rad2", "rad²", "the same in yaw");
    option(prediction_share, "prediction_share", "factor",
           "on the information of the expected pose while the match is refined: it must not hold it back");
    option(looked_along_m, "looked_along_m", "m",
           "how far along its weakest direction the uncertainty of a match is looked for");
    option(max_patches, "max_patches", "count", "of the map that the scan is matched with");
    option(agreeing_m, "agreeing_m", "m", "two finds agree that would move the map by the same within this");
    option(agreeing_rad, "agreeing_rad", "rad", "and turn it by the same within this");
    option(min_agreeing, "min_agreeing", "count", "of agreeing finds that close a loop of a wide window");
    option(min_way_m, "min_way_m", "m", "of way between two of them");
    option(max_waiting, "max_waiting", "count", "of finds of one robot that wait; the oldest goes");
  }
};

/// Walls in free space, see map/contradiction.hpp.
struct ContradictionOptions {
  double deep_m = 0.5;
  std::size_t points = 60;
  int min_in_view = 15;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(deep_m, "deep_m", "m",
           "a hit so far in front of what the other patch saw lies in its free space, one so far behind is "
           "hidden from it");
    option(points, "points", "count", "of hits of a patch that are looked at");
    option(min_in_view, "min_in_view", "count",
           "of hits of both: with fewer in view the two hardly look at the same place");
  }
};

/// Fits of windows and of whole islands, see map/map.hpp and map/fit_job.hpp.
struct MapFitOptions {
  std::size_t window_patches = 40;
  std::size_t loop_patches = 150;
  std::int64_t us_per_patch = 20'000;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(window_patches, "window_patches", "count",
           "of patches, nearest in the graph, that are fitted when one is added");
    option(loop_patches, "loop_patches", "count",
           "of patches that are fitted at once when a local loop closes; the island follows");
    option(
        us_per_patch, "us_per_patch", "µs",
        "of event time after which a whole island's fit is applied, per patch of the map: hardly ever late");
  }
};

/// What is wrong where a closure is at odds with the map, see map/weak_link.hpp.
struct WeakLinkOptions {
  double match_log_odds = 8;
  double odometry_log_odds = 4;
  double slip_m = 1;
  double slip_rad = 0.3;
  ChiSquaredBound agreeing{0.999, 3};

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(match_log_odds, "match_log_odds", "log-odds",
           "that a scan was placed where it belongs, and that two patches were matched rightly: one in three "
           "thousand is not");
    option(odometry_log_odds, "odometry_log_odds", "log-odds",
           "that odometry did not slip, freeze or jump between two patches: once in fifty it does");
    option(slip_m, "slip_m", "m",
           "scale of the Cauchy distribution of how far a wrong link is off: half of them by 1.7 times that, "
           "one "
           "in a hundred by a hundred times");
    option(slip_rad, "slip_rad", "rad", "the same of its yaw, half of them by more than this");
    option(agreeing, "agreeing", "probability",
           "χ² of 3 of a relation of the link that is right for all that, and stays");
  }
};

}  // namespace isthmus
