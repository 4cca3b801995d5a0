#pragma once

#include <cstdint>

#include "server/engine/input/options/common_options.hpp"

namespace isthmus {

/// What sightings say of relative poses, see sightings/alignment.hpp.
struct AlignmentOptions {
  CommonOptions common;
  double floor_m = 0.05;
  double floor_rad = 0.03;
  double min_baseline_m = 0.4;
  std::int64_t rival_us = 10'000'000;
  std::int64_t lone_pair_us = 3'000'000;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(floor_m, "floor_m", "m",
           "standard deviation that stamps, mounts and odometry leave open in a sighting, whatever it says");
    option(floor_rad, "floor_rad", "rad", "the same of its bearing");
    option(min_baseline_m, "min_baseline_m", "m", "between two points that give a relative pose");
    option(rival_us, "rival_us", "µs", "around the supporters: who disagrees within it is a rival");
    option(lone_pair_us, "lone_pair_us", "µs", "that a pair of sightings waits for a third");
  }
};

/// Sightings as relations, and the places of fixed tags, see sightings/evidence.hpp.
struct EvidenceOptions {
  CommonOptions common;
  double correlation = 2;
  double robust_scale = 3;
  double no_yaw_sigma_rad = 100;
  double min_range_m = 0.1;
  double no_range_m = 1;
  double min_apart_m = 0.5;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(correlation, "correlation", "factor",
           "on sigmas: successive sightings err together (a camera's calibration, a late stamp), and each is "
           "a relation of its own");
    option(robust_scale, "robust_scale", "sigmas", "of the loss on a sighting's relation");
    option(no_yaw_sigma_rad, "no_yaw_sigma_rad", "rad",
           "of a tag's yaw, which means nothing: a fit needs one");
    option(min_range_m, "min_range_m", "m", "that counts where a range turns position into bearing");
    option(no_range_m, "no_range_m", "m", "the range of a bearing alone, for the same");
    option(min_apart_m, "min_apart_m", "m", "or two from places so far apart");
  }
};

}  // namespace isthmus
