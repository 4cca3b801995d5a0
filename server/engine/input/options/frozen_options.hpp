#pragma once

#include <cstddef>
#include <cstdint>

#include "patches/option_unit.hpp"
#include "server/engine/input/options/common_options.hpp"

namespace isthmus {

/// Finding a robot that is somewhere on a finished map, see frozen/finder.hpp. Anchors and windows are those
/// of place_candidates.
struct FinderOptions {
  CommonOptions common;
  double min_piece_way_m = 2;
  double min_half_window_rad = 0.15;
  double min_find_probability = 0.5;
  std::size_t max_sketch_patches = 150;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(min_piece_way_m, "min_piece_way_m", "m", "of its way before it is searched for");
    option(min_half_window_rad, "min_half_window_rad", "rad",
           "of a window: one that is too much for one step is searched in halves down to this");
    option(min_find_probability, "min_find_probability", "probability", "of a find, that it was there");
    option(max_sketch_patches, "max_sketch_patches", "count", "of its sketch, which then begins anew");
  }
};

/// Following robots over a finished map, see frozen/frozen.hpp.
struct FrozenOptions {
  CommonOptions common;
  double doubted_m = 2;
  double given_up_m = 10;
  double min_given_score = 0.55;
  double given_sigmas = 2;
  long given_evaluations = 100'000;
  std::int64_t given_told_us = 30'000'000;
  std::int64_t sighting_every_us = 5'000'000;
  double work_share = 0.3;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(doubted_m, "doubted_m", "m",
           "of odometry since the last match: the robot's place is a guess, it is looked for elsewhere too");
    option(given_up_m, "given_up_m", "m", "of it, after which it is looked for elsewhere only");
    option(min_given_score, "min_given_score", share_unit,
           "of that search: less than of a search all over the map, as somebody says that it is there");
    option(
        given_sigmas, "given_sigmas", "sigmas",
        "half the window about a pose that somebody gives: a wider one holds other places that look alike");
    option(given_evaluations, "given_evaluations", "count",
           "correlative.max_evaluations of that search, which is done once an order");
    option(given_told_us, "given_told_us", "µs",
           "of event time that it is told that a given pose does not fit");
    option(sighting_every_us, "sighting_every_us", "µs",
           "of event time between two sightings by which one robot is looked for");
    option(work_share, "work_share", share_unit, "of event time for the search: nothing else is to be done");
  }
};

}  // namespace isthmus
