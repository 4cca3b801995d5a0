#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/engine/input/configuration.hpp"
#include "server/engine/record/map_copy.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// A relation of a map that says of two patches what is not true.
struct WrongRelation {
  RelationId relation;
  PatchId a;
  PatchId b;
  OriginKind origin = OriginKind::match;
  double off_m = 0;
  double off_rad = 0;
};

/// What a map's relations from scans (of origin match, propagation and hypothesis) are worth against the
/// truth of its run. One is wrong where it puts its patches more than 1 m or 20 degrees from where they are
/// to one another, and its noise leaves no room for the truth.
struct ClosureScore {
  std::size_t relations = 0;
  std::vector<WrongRelation> wrong;
  /// Wrong relations of the same two places and times are one wrong closure.
  std::size_t wrong_closures = 0;
  std::size_t islands = 0;
  /// Pairs of robots' stretches that are on one island, more than 1 m or 20 degrees from where they are to
  /// one another, where they come nearest.
  std::size_t wrong_merges = 0;
};
ClosureScore judge_closures(const MapCopy& map, const std::vector<RobotTruth>& truth);

/// One seed.
struct ClosureTrial {
  std::uint64_t seed = 0;
  ClosureScore score;
  std::size_t closures_accepted = 0;  ///< by sightings and hypotheses
  std::size_t compared = 0;           ///< true relations between scans that the map has an opinion of
  std::size_t missing = 0;
  double mean_error_m = 0;
};
ClosureTrial try_closures(const Scenario& scenario, std::uint64_t seed,
                          const Configuration& configuration = {});

/// Whether a trial's map is worse than another's: more wrong closures and merges, then the larger error.
bool is_worse(const ClosureTrial& a, const ClosureTrial& b);

}  // namespace isthmus
