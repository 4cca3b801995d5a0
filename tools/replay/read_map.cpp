#include "tools/replay/read_map.hpp"

#include <chrono>
#include <stdexcept>

#include "server/wire/journal/journal_files.hpp"
#include "server/wire/journal/recovery/recovery.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

ReplayResult finished(const std::string& path, ServedMap map, Clock::time_point start,
                      const ReplayOptions& options) {
  if (map.features)
    throw std::runtime_error(path + ": its map is one of features; isthmus-replay makes it of the journal");
  ReplayResult result;
  result.engine = std::move(map.engine);
  finish_map(result.engine, options);
  result.messages = map.events;
  result.cost.wall_s = seconds_of(Clock::now() - start);
  result.cost.cpu_s = process_cpu_s();
  result.cost.peak_rss_mb = process_peak_rss_mb();
  return result;
}

ServedMap recovered(const std::string& journal, const ReplayOptions& options) {
  RecoveryOptions recovery_options;
  recovery_options.warn = options.warn;
  Recovery recovery(journal, recovery_options);
  ServedMap map = recovery.begin();
  while (recovery.step(map))
    if (options.progress) options.progress(recovery.progress());
  return map;
}

}  // namespace

ReplayResult read_map(const std::string& path, const ReplayOptions& options) {
  const Clock::time_point start = Clock::now();
  if (is_snapshot(path)) {
    if (!options.config_file.empty())
      throw std::runtime_error(path + ": a snapshot keeps the configuration that it was made with");
    return finished(path, read_snapshot(path).map, start, options);
  }
  if (is_journal(path) && options.config_file.empty())
    return finished(path, recovered(path, options), start, options);
  return replay(path, options);
}

}  // namespace isthmus
