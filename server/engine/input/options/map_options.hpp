#pragma once

#include <cstddef>
#include <cstdint>

#include "patches/option_unit.hpp"
#include "server/engine/input/options/common_options.hpp"

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

  /// Of a local map.
  std::size_t max_patches() const {
    return static_cast<std::size_t>(oldest) + static_cast<std::size_t>(newest);
  }

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
  CommonOptions common;
  double min_paired = 0.35;
  double unambiguous_half_width_m = 0.6;
  double window_sigmas = 2.5;
  double max_window_m = 6;
  double max_window_rad = 0.7;
  double min_way_m = 2;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(min_paired, "min_paired", share_unit, "of the beams that must then have found something");
    option(unambiguous_half_width_m, "unambiguous_half_width_m", "m",
           "a search window as narrow as this leaves nothing else that could be meant");
    option(window_sigmas, "window_sigmas", "sigmas", "half width of the window that is searched");
    option(max_window_m, "max_window_m", "m", "half width of the widest window that is searched at once");
    option(max_window_rad, "max_window_rad", "rad", "the same in yaw");
    option(min_way_m, "min_way_m", "m", "of way between two of them");
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
  std::int64_t us_per_patch = 20'000;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(window_patches, "window_patches", "count",
           "of patches, nearest in the graph, that are fitted when one is added");
    option(us_per_patch, "us_per_patch", "µs",
           "of event time after which a whole island's fit is applied, per patch of it: hardly ever late");
  }
};

/// What is wrong where a closure is at odds with the map, see map/weak_link.hpp.
struct WeakLinkOptions {
  CommonOptions common;
  double match_log_odds = 8;
  double odometry_log_odds = 4;
  double slip_m = 1;

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
  }
};

}  // namespace isthmus
