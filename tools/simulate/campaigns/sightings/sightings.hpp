#pragma once

#include <string>
#include <vector>

#include "server/engine/input/configuration.hpp"
#include "server/engine/record/map_copy.hpp"
#include "tools/simulate/run/simulation.hpp"
#include "tools/simulate/truth/truth_files.hpp"

namespace isthmus {

/// What a map made of a run's sightings.
struct SightingScore {
  std::size_t true_ones = 0;
  std::size_t true_accepted = 0;
  std::size_t false_ones = 0;
  std::size_t false_accepted = 0;

  double true_share() const;  ///< of the true ones that were accepted; 1 where there are none
};

/// A sighting is false if it is off by more than 1 m or 20 degrees, or names who is not there. One that was
/// spoilt and is still right counts among the true ones. Throws std::runtime_error where the map does not
/// have one record for each sighting of the run.
SightingScore judge_sightings(const SimulatedRun& run, const SightingLog& records);

/// Translational errors over true relations of one kind, those that both maps can tell.
struct RelationComparison {
  std::size_t compared = 0;
  std::size_t missing = 0;        ///< that the first map cannot tell: no pose, or on two islands
  std::size_t missing_clean = 0;  ///< and that the other cannot
  double mean_m = 0;
  double mean_clean_m = 0;

  void add(const RelationComparison& other);
};
RelationComparison compare(const std::vector<ScanRelation>& relations, const MapCopy& map,
                           const MapCopy& clean);

/// One seed: a run with false sightings and the same run without.
struct SightingTrial {
  std::uint64_t seed = 0;
  SightingScore score;
  SightingScore clean_score;
  std::size_t islands = 0;
  std::size_t clean_islands = 0;
  RelationComparison intra;
  RelationComparison inter;

  double error_ratio() const;  ///< of mean errors over all compared relations; 1 where there are none
};
SightingTrial try_sightings(const Scenario& scenario, std::uint64_t seed, double false_share,
                            const Configuration& configuration = {});

/// A row for each trial. Throws std::runtime_error naming the file and the reason.
void write_trials(const std::vector<SightingTrial>& trials, const std::string& file);

}  // namespace isthmus
