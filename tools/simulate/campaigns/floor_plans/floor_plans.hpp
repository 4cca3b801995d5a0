#pragma once

#include <cstdint>

#include "server/output/vector_plan/vector_plan.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// A vector floor plan against the building that was simulated.
struct PlanScore {
  std::size_t walls = 0;
  double drawn_m = 0;       ///< length of all walls of the plan
  double rms_m = 0;         ///< distance of what is drawn from the nearest true surface, of that within 0.1 m
  double worst_5_m = 0;     ///< 5 % of that is farther away
  double false_share = 0;   ///< of what is drawn: farther than 0.1 m from every surface
  double seen_m = 0;        ///< length of true surfaces that at least ten beams hit
  double found_share = 0;   ///< of it: within 0.05 m of what is drawn
  double walls_seen_m = 0;  ///< the same of faces that are straight for at least 1 m
  double walls_found_share = 0;  ///< of those
  std::size_t openings = 0;
  std::size_t poles = 0;
  double plan_cpu_s = 0;
};

/// Compares at points 5 cm apart. Hits of scans are placed by the truth.
PlanScore score_plan(const VectorPlan& plan, const Pose& world_from_map, const FloorPlan& floor,
                     const SimulatedRun& run);

/// Maps a run by the engine, draws the plan of its largest island, and scores it where the island's patches
/// together lie nearest to where they were.
PlanScore try_floor_plan(const Scenario& scenario, std::uint64_t seed, const PlanOptions& options = {});

}  // namespace isthmus
