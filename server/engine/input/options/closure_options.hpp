#pragma once

#include <cstddef>
#include <cstdint>

namespace isthmus {

/// What becomes of sightings (Howard et al. 2006, IV-C), see sightings/ and closures/.
struct ClosureOptions {
  std::int64_t placing_wait_us = 2'000'000;
  std::int64_t weighing_us = 2'000'000;
  double known_sigma_without_scans_m = 0.6;
  std::size_t patches_without_scans = 60;
  double another_tag_m = 0.3;
  int max_judged_again = 4;
  std::int64_t encounter_us = 60'000'000;
  std::size_t max_waiting = 400;
  std::size_t max_compared = 24;
  double retry_growth = 1.5;
  std::size_t max_reopened = 2'000;
  double tells_apart = 1;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(placing_wait_us, "placing_wait_us", "µs", "that a sighting waits for odometry");
    option(weighing_us, "weighing_us", "µs",
           "between sightings of one target by one observer that are weighed against the map's confidence");
    option(known_sigma_without_scans_m, "known_sigma_without_scans_m", "m",
           "the same where scans do not tie the two together");
    option(patches_without_scans, "patches_without_scans", "count",
           "that are looked at there: tags tie everything to everything, a dense graph");
    option(another_tag_m, "another_tag_m", "m",
           "from a tag, within which another is taken for a misread one, unless common.overruling sightings "
           "say so");
    option(max_judged_again, "max_judged_again", "count", "in one event: each may ask for a covariance");
    option(encounter_us, "encounter_us", "µs", "sightings of a loop so far apart are different encounters");
    option(max_waiting, "max_waiting", "count", "of sightings of one group, or of a tag that is nowhere");
    option(max_compared, "max_compared", "count", "of them, taken evenly, each with each");
    option(retry_growth, "retry_growth", "factor",
           "in a group's sightings after which a joining that was refused is tried again");
    option(max_reopened, "max_reopened", "count",
           "of refused sightings, the newest, that are looked at again once a merge was contradicted");
    option(tells_apart, "tells_apart", "log-odds",
           "by which a loop must make a joining likelier than it was to count as the same");
  }
};

}  // namespace isthmus
