#pragma once

#include <span>
#include <vector>

#include "relations/graph.hpp"

namespace isthmus {

struct FitOptions {
  int max_iterations = 20;
  /// Start from the linear "chordal" solution; keep it only where it costs less than the given poses.
  bool chordal_start = false;
  /// Ceres' relative function tolerance.
  double function_tolerance = 1e-8;
};

struct FitReport {
  bool ok = false;  ///< a usable solution was found; otherwise the poses are untouched
  double cost_before = 0;
  double cost_after = 0;
  int iterations = 0;
  std::string message;
};

/// Maximum likelihood fit (eqs. 5, 6, 16) of the patches `free`, over every relation of the graph that
/// touches one of them; the patches at the other ends are held. Where no other end is held, the first of
/// `free` is held as the gauge. `poses` is indexed by patch id and changed only on success. Deterministic;
/// one thread.
FitReport fit(const RelationGraph& graph, std::span<const PatchId> free, std::span<Pose> poses,
              const FitOptions& options = {});

/// The whole island of a patch: chordal start as the options say, its lowest patch held.
FitReport fit_island(const RelationGraph& graph, IslandId island, std::span<Pose> poses,
                     const FitOptions& options = {});

}  // namespace isthmus
