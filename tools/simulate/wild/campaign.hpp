#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/engine/input/configuration.hpp"
#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/wild/draw.hpp"
#include "tools/simulate/wild/judge.hpp"

namespace isthmus {

/// One seed.
struct WildTrial {
  std::uint64_t seed = 0;
  WildPlace place = WildPlace::building;
  bool finished = false;  ///< else the process ended before it had a map; what it said is on stderr
  WildScore score;
  Confidence local_map;  ///< of poses relative to patches that are near and well determined
  Confidence island;     ///< of poses relative to any patch of the island
  std::size_t scans = 0;
  double simulation_cpu_s = 0;
  double cpu_s = 0;  ///< of mapping

  bool failed() const { return !finished || score.failed(); }
  WildDraw draw() const { return draw_wild(seed, place); }
};

/// Draws a run, maps it and judges the map. `directory`: where the log of a run that fails is kept, with its
/// truth, in a folder of its own; empty: nowhere.
WildTrial try_wild(std::uint64_t seed, const std::string& directory = {},
                   const Configuration& configuration = {}, WildPlace place = WildPlace::building);

/// Writes a drawn run as a log, with the truth beside it; either may be empty. Throws std::runtime_error
/// naming the file and the reason.
void write_wild(const WildDraw& draw, const std::string& log, const std::string& truth);

/// Tries seeds by `attempt`, each in a process of its own, `jobs` at a time, and passes the trials to `done`
/// in order of the seeds. Throws std::runtime_error where no process can be had.
void try_seeds(std::uint64_t first, std::uint64_t count, unsigned jobs,
               const std::function<WildTrial(std::uint64_t)>& attempt,
               const std::function<void(const WildTrial&)>& done);

/// How often a trait is drawn among the runs that failed, and among the others.
struct WildTraitShare {
  std::string name;
  double of_failed = 0;
  double of_others = 0;
};
/// Those that failed runs have most above the others first.
std::vector<WildTraitShare> compare_traits(const std::vector<WildTrial>& trials);

/// A row for each trial: its score and what was drawn. Throws std::runtime_error naming the file and the
/// reason.
void write_wild_trials(const std::vector<WildTrial>& trials, const std::string& file);

}  // namespace isthmus
