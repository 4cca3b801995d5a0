#pragma once

#include <cstddef>
#include <cstdint>

#include "patches/option_unit.hpp"

namespace isthmus {

/// What becomes of sightings (Howard et al. 2006, IV-C), see sightings/ and closures/.
struct ClosureOptions {
  std::int64_t placing_wait_us = 2'000'000;
  std::int64_t weighing_us = 2'000'000;
  int near_hops = 3;
  double known_sigma_m = 0.3;
  double known_sigma_without_scans_m = 0.6;
  std::size_t patches_without_scans = 60;
  double informative = 1;
  double another_tag_m = 0.3;
  std::size_t min_beside_another = 6;
  double min_apart_beside_another_m = 1;
  std::size_t max_for_tag = 30;
  int max_judged_again = 4;
  std::int64_t encounter_us = 60'000'000;
  std::size_t max_waiting = 400;
  std::size_t max_compared = 24;
  double retry_growth = 1.5;
  std::size_t max_reopened = 2'000;
  std::int64_t max_credit_us = 10'000;
  double alike_m = 1;
  double alike_rad = 0.35;
  double tells_apart = 1;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(placing_wait_us, "placing_wait_us", "µs", "that a sighting waits for odometry");
    option(weighing_us, "weighing_us", "µs",
           "between sightings of one target by one observer that are weighed against the map's confidence");
    option(near_hops, "near_hops", "count", "of relations: so near in the graph, the map knows better");
    option(known_sigma_m, "known_sigma_m", "m",
           "standard deviation: a map that knows less well than this where the target is learns from a "
           "sighting only "
           "when others agree");
    option(known_sigma_without_scans_m, "known_sigma_without_scans_m", "m",
           "the same where scans do not tie the two together");
    option(patches_without_scans, "patches_without_scans", "count",
           "that are looked at there: tags tie everything to everything, a dense graph");
    option(informative, "informative", "factor",
           "on a sighting's own sigma: the map must know less well than that to learn from it");
    option(another_tag_m, "another_tag_m", "m",
           "from a tag, within which another is taken for a misread one,");
    option(min_beside_another, "min_beside_another", "count", "unless so many sightings say so,");
    option(min_apart_beside_another_m, "min_apart_beside_another_m", "m", "from places so far apart");
    option(max_for_tag, "max_for_tag", "count", "of newest sightings of a tag that is nowhere yet");
    option(max_judged_again, "max_judged_again", "count", "in one event: each may ask for a covariance");
    option(encounter_us, "encounter_us", "µs", "sightings of a loop so far apart are different encounters");
    option(max_waiting, "max_waiting", "count", "of sightings of one group, or of a tag that is nowhere");
    option(max_compared, "max_compared", "count", "of them, taken evenly, each with each");
    option(retry_growth, "retry_growth", "factor",
           "in a group's sightings after which a joining that was refused is tried again");
    option(max_reopened, "max_reopened", "count",
           "of refused sightings, the newest, that are looked at again once a merge was contradicted");
    option(max_credit_us, "max_credit_us", "µs", "of event time for trials that can be saved up");
    option(
        alike_m, "alike_m", "m",
        "within which two joinings say the same however sharp both are: walls that repeat are farther apart");
    option(alike_rad, "alike_rad", "rad", "the same of the yaw");
    option(tells_apart, "tells_apart", "log-odds",
           "by which a loop must make a joining likelier than it was to count as the same");
  }
};

}  // namespace isthmus
