#pragma once

#include <span>
#include <vector>

#include "relations/graph.hpp"

namespace isthmus {

/// What one fit looks at: the free patches that have relations, the patches held at the other ends, and every
/// relation that touches a free one. Patches are named by their place in `patches`, the free ones first.
struct FitProblem {
  struct Link {
    const Relation* relation;
    int a;
    int b;
  };

  std::vector<PatchId> patches;
  int free_count = 0;
  std::vector<Link> links;

  bool is_free(int place) const { return place < free_count; }
};

/// A place in the problem's lists, as their index.
inline std::size_t at(int place) { return static_cast<std::size_t>(place); }

/// Wherever a connected part of the free patches has no held patch at its border, its first patch in the
/// order of `free` is held as the gauge.
FitProblem make_fit_problem(const RelationGraph& graph, std::span<const PatchId> free);

/// The poses of the problem's patches in its own order.
std::vector<Pose> poses_of(const FitProblem& problem, std::span<const Pose> by_patch_id);

/// Sum of the relations' costs, robust losses applied. `poses` in the problem's order.
double cost(const FitProblem& problem, std::span<const Pose> poses);

}  // namespace isthmus
