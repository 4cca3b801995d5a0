#pragma once

#include <vector>

#include "isthmus/goal_t.hpp"
#include "server/exploration/explore.hpp"

namespace isthmus {

/// A team that explores, at one time.
struct TeamGoals {
  std::vector<goal_t> goals;               ///< of all robots that are planned for
  std::vector<ExplorationGoal> frontiers;  ///< of which those were chosen, and others
};

}  // namespace isthmus
