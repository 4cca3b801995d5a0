#pragma once

#include <string>
#include <vector>

#include "relations/relation.hpp"

namespace isthmus {

/// A closure that scans propose (hypotheses.hpp): how a patch of one island lies to one of another, by
/// several finds that agree.
struct ScanProposal {
  ClosureId id;   ///< of a record there is already; invalid: a new one
  PatchId first;  ///< of the older island, in a merge
  PatchId second;
  Pose first_from_second;
  std::vector<Relation> relations;  ///< of the finds; their origin is still to be given
  int finds = 0;
  double log_odds = 0;  ///< that they are true, before it is tried
  double way_m = 0;     ///< of a loop: what lies between its ends, over the map
  /// Their relative position is weakly known.
  bool cautious = false;
  /// Among how many places that look alike it was found (places/place_search.hpp); 1: it is the only one.
  int look_alikes = 1;
  std::vector<std::string> robots;
};

}  // namespace isthmus
