#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "patches/option_unit.hpp"
#include "patches/pose.hpp"
#include "relations/chi_squared.hpp"

namespace isthmus {

/// What several rooms decide by, so that each of these numbers stands for one thing wherever it is used. A
/// room whose code takes only a struct of its own finds a copy in that, see EngineOptions::share_common().
struct CommonOptions {
  ChiSquaredTest surprise{0.999};
  ChiSquaredTest plausible{0.95};
  double window_sigmas = 3;
  double lever_m = 6;
  double apart_m = 1;
  double agreeing_m = 0.4;
  int agreeing = 3;
  int overruling = 6;
  double baseline_m = 1;
  double sure_score = 0.6;
  double doubtful_score = 0.45;
  double known_sigma_m = 0.3;
  int near_hops = 4;
  int max_lost_scans = 8;
  std::size_t max_finds = 64;
  std::int64_t max_credit_us = 10'000;

  /// The yaw by which what lies at the lever is moved so far.
  double yaw_rad(double distance_m) const { return distance_m / lever_m; }

  /// Whether a pose is no farther from another than this, nor turned by more than moves the lever so far.
  bool is_within(const Pose& off, double distance_m) const {
    return std::hypot(off.x, off.y) <= distance_m && std::abs(off.yaw) <= yaw_rad(distance_m);
  }

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(surprise, "surprise", "probability", "χ²: of what is true that it is no surprise");
    option(plausible, "plausible", "probability", "χ²: of what is true that it is taken as it is");
    option(window_sigmas, "window_sigmas", "sigmas", "half width of a window that is searched");
    option(lever_m, "lever_m", "m",
           "characteristic length: a rotation counts as far as it moves what is seen so far away");
    option(apart_m, "apart_m", "m", "two answers farther apart than this are two places");
    option(agreeing_m, "agreeing_m", "m", "two finds agree that would move the map by the same within this");
    option(agreeing, "agreeing", "count",
           "of observations (sightings, finds, matches) that agree, which one that is wrong cannot");
    option(overruling, "overruling", "count",
           "of sightings that agree, by which they stand against what else would be believed");
    option(baseline_m, "baseline_m", "m",
           "between the places of observations that agree: nearer ones err alike");
    option(sure_score, "sure_score", share_unit,
           "of a match or a search, that is believed where nothing else says that the robot is there");
    option(
        doubtful_score, "doubtful_score", share_unit,
        "of a match of one scan, below which it tells nothing alone: the scan is looked for anew in all that "
        "lies near, and carries no loop");
    option(near_hops, "near_hops", "count",
           "of relations: so near in the graph, two patches are known to be near one another");
    option(
        known_sigma_m, "known_sigma_m", "m",
        "standard deviation: who knows less well than this where something is learns from others only when "
        "they agree");
    option(max_lost_scans, "max_lost_scans", "count",
           "of scans in a row, unmatched after implausible odometry: the robot is somewhere else");
    option(max_finds, "max_finds", "count", "that wait for others that agree; the oldest goes");
    option(max_credit_us, "max_credit_us", "µs", "of a share of event time that can be saved up");
  }
};

}  // namespace isthmus
