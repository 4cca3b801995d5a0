#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "patches/manifold.hpp"
#include "relations/graph.hpp"
#include "server/engine/input/options/map_options.hpp"

namespace isthmus {

/// Which patches are compared with one another, and when they contradict one another.
struct ContradictingPairsOptions {
  double reach_m = 6;             ///< between patches that are compared
  std::size_t max_compared = 40;  ///< with one patch, the nearest
  double min_share = 0.6;         ///< of hits in the other's free space, of a pair that contradicts itself
  ContradictionOptions contradiction;
};

/// Patches as they lie in their islands, to be compared with what lies around them and is not related to
/// them: walls of either stand where the other looked through.
class LaidOut {
 public:
  /// Keeps references.
  LaidOut(const RelationGraph& graph, std::span<const PatchPtr> patches, std::span<const Pose> poses);

  /// Those that contradict one, nearest first. None for a fixed tag.
  std::vector<PatchId> contradicted_by(PatchId id, const ContradictingPairsOptions& options) const;

 private:
  std::vector<PatchId> unrelated_around(PatchId id, const ContradictingPairsOptions& options) const;

  const RelationGraph& graph_;
  std::span<const PatchPtr> patches_;
  std::span<const Pose> poses_;
  std::vector<std::pair<double, PatchId>> along_x_;
};

}  // namespace isthmus
