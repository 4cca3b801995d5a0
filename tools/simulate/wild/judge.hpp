#pragma once

#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "tools/simulate/truth/truth_files.hpp"

namespace isthmus {

/// Pairs of times to judge a map by, as those of the benchmark logs: neighbours along each robot's way, and
/// two robots' or one robot's times half a minute and more apart at which it was within 3 m of where it had
/// been, with nothing in between.
std::vector<ScanRelation> wild_relations(const Scenario& scenario, const std::vector<RobotTruth>& truth);

/// What became of a run. Plain data: it goes from one process to another.
struct WildScore {
  std::size_t islands = 0;
  std::size_t relations = 0;
  std::size_t missing = 0;  ///< relations that the map cannot tell
  double mean_m = 0;
  double max_m = 0;
  std::size_t wrong_merges =
      0;  ///< pairs of stretches on one island that lie wrongly where they come nearest
  std::size_t missed_merges =
      0;  ///< pairs of robots, or of one robot's islands, that share 15 m and no island
  std::size_t true_sightings = 0;
  std::size_t true_accepted = 0;
  std::size_t false_sightings = 0;
  std::size_t false_accepted = 0;

  bool is_off() const { return max_m > 1; }
  bool failed() const { return is_off() || wrong_merges > 0 || missed_merges > 0; }
};
WildScore judge_wild(const Scenario& scenario, const SimulatedRun& run, const MapCopy& map);

}  // namespace isthmus
