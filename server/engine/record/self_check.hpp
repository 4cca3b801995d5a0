#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/engine/map/contradicting_pairs.hpp"
#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// A stretch of the map that does not go with what lies over it: walls of either stand where the other looked
/// through. Most often a place that is on the map twice.
struct SelfContradiction {
  IslandId island;
  Eigen::Vector2d centre_m;         ///< of its patches, in the island's frame
  std::vector<PatchId> patches;     ///< by id
  std::vector<std::string> robots;  ///< who saw them, by name
  int pairs = 0;                    ///< of patches that contradict one another
};

/// Chosen on maps of four recorded buildings: where they are right, no more than 5 pairs hang together
/// (people, doors, glass); in one drawn twice, 179.
struct SelfCheckOptions {
  ContradictingPairsOptions compared;
  int min_pairs = 10;  ///< that hang together
};

/// Compares the patches of a map with what lies around them and is not related to them, each in its turn: a
/// call costs what it is given patches. Nothing of it goes back into the map.
class SelfCheck {
 public:
  explicit SelfCheck(const SelfCheckOptions& options = {}) : options_(options) {}

  /// Looks at the next so many patches, and begins again behind the last one.
  void look_at(const MapCopy& map, std::size_t patches);

  /// What was found when each patch was last looked at; of most pairs first.
  std::vector<SelfContradiction> found(const MapCopy& map) const;

 private:
  SelfContradiction spread_from(std::size_t first, const MapCopy& map, std::vector<bool>& seen) const;

  SelfCheckOptions options_;
  std::size_t next_ = 0;
  std::vector<std::vector<PatchId>> contradicted_by_;  // by patch id, of both of a pair
};

/// All patches looked at once.
std::vector<SelfContradiction> self_contradictions(const MapCopy& map);

}  // namespace isthmus
