#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/paths/questions/planner.hpp"
#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// What paths between random pairs of places of a map's largest island are worth.
struct PathScore {
  std::size_t pairs = 0;                   ///< that the grid of the whole island joins
  std::map<Refusal, std::size_t> missing;  ///< of them without a path, and why
  std::size_t through = 0;                 ///< paths through an occupied cell of the grid
  std::size_t too_near = 0;                ///< nearer to one than asked
  std::size_t too_long = 0;                ///< more than 1.05 of the optimum
  double mean_ratio = 0;                   ///< of a path's length to the optimum
  double worst_ratio = 0;
  std::array<Eigen::Vector2d, 2> worst;  ///< from where to where that was
  double p50_ms = 0;                     ///< CPU of a question
  double p99_ms = 0;
  double max_ms = 0;
  double keep_ms = 0;     ///< CPU of the ground from nothing
  double roadmap_ms = 0;  ///< and of the roadmap for the footprint
};

/// The optimum is that of the projected grid as it is written (GridOptimum): right for a map whose loops are
/// closed. Pairs are drawn by the seed. `picture`: where an image of the first eight paths goes; empty:
/// nowhere.
PathScore score_paths(std::shared_ptr<const MapCopy> map, std::size_t pairs, std::uint64_t seed,
                      const Footprint& footprint, const std::string& picture);

/// What paths on the maps of a run are worth while it is made: drivable in the building as it truly is.
struct DriveScore {
  std::size_t paths = 0;
  /// Without a path between two places where robots of one island were, and why.
  std::map<Refusal, std::size_t> missing;
  std::size_t touching = 0;  ///< a robot that drove it would touch something
  double metres = 0;
};

/// Asks for paths between random patches of the map that a run makes up to `until_s`, and drives them: from
/// each pose to the next by what the robot would see, that is as the two patches' true poses have it.
DriveScore score_drives(const SimulatedRun& run, const FloorPlan& plan, double until_s, std::size_t pairs,
                        std::uint64_t seed, const Footprint& footprint);

/// What robots are told of where the others of their island are, every so many seconds of a run, against the
/// truth. `unknown`: pairs of one island without an answer.
struct TeammateScore {
  ConfidenceTally tally;
  std::size_t unknown = 0;
};
TeammateScore score_teammates(const SimulatedRun& run, double interval_s);

}  // namespace isthmus
