#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "server/engine/engine.hpp"
#include "server/output/output.hpp"
#include "tools/replay/cost_profile.hpp"

namespace isthmus {

struct ReplayOptions {
  std::string config_file;        ///< empty: the log's own configuration, if it begins with one
  std::vector<ClosureId> forbid;  ///< closures that must not be made
  /// Reading stops at the first event so long after the log's first; what was read is finished as a log is.
  double until_s = std::numeric_limits<double>::infinity();
  /// The whole map is matched and fitted once more at the end, as by the command `refine`, and then every
  /// scan is matched with it (Refinement), in a second pass over the log.
  bool refine = false;
  /// Called at the first event and then after each so many seconds of event time.
  std::function<void(const Engine&, double event_s)> sample;
  double sample_every_s = 60;
  std::function<void(double)> progress;
  /// Called before each piece of what is done after the last event, with its name.
  std::function<void(const std::string&)> finishing;
  std::function<void(const std::string&)> warn;  ///< of what is damaged, or cannot be verified
};

/// Finishes the map of an engine, and reports as the options say.
void finish_map(Engine& engine, const ReplayOptions& options);

struct ReplayResult {
  Engine engine;
  std::shared_ptr<const TrajectoryStore> refined;  ///< the trajectory after the second pass; none without one
  std::size_t scans_refined = 0;
  RunCost cost;
  LatencyHistogram event_cpu;       ///< CPU time of the engine's own thread per event: latency but for waits
  CostProfile scan_cost;            ///< CPU time of the engine from one scan to the next
  std::int64_t messages = 0;        ///< read from the log
  std::int64_t ignored = 0;         ///< on channels that are not input
  std::int64_t skipped_bytes = 0;   ///< damaged
  std::int64_t missing_events = 0;  ///< that a journal is known to lack

  /// The map with the best trajectory there is.
  MapCopy map() const;
};

/// The path, once it is known that it is no journal with events missing at its beginning. Throws
/// std::runtime_error naming it.
const std::string& whole_log(const std::string& path);

/// Runs the engine over an LCM event log or a journal directory, as fast as it can, to the end or as far as
/// `until_s` says (Engine::finish included). Throws std::runtime_error naming file, event or line and reason:
/// no log, a bad configuration.
ReplayResult replay(const std::string& path, const ReplayOptions& options = {});

}  // namespace isthmus
