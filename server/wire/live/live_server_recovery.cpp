// How a LiveServer goes on with the journal that it found.

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "server/wire/journal/event_log.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/live/live_server.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds recovery_report_interval(5);

/// Of the last events that segments of a journal hold; 0: they hold none.
std::int64_t newest_utime(const std::vector<JournalSegment>& segments) {
  std::int64_t newest = 0;
  for (auto segment = segments.rbegin(); segment != segments.rend() && newest == 0; ++segment) {
    EventLogReader reader(segment->path);
    while (const std::optional<Message> message = reader.next()) newest = std::max(newest, message->utime);
  }
  return newest;
}

}  // namespace

RecoveryOptions LiveServer::recovery_options() const {
  RecoveryOptions options;
  if (journal_) options.last_segment = journal_->segment() - 1;
  options.guard = guard_.get();
  options.report_set_aside = [this](const std::string& text) { say(LogLevel::error, text, {}); };
  options.before_event = options_.before_event;
  options.warn = [this](const std::string& warning) { say(LogLevel::warning, warning, {}); };
  return options;
}

void LiveServer::begin_recovery() {
  map_ = recovery_->begin();
  if (options_.frozen && map_.features)
    throw std::runtime_error(options_.journal_directory +
                             ": robots are localised in a manifold map only (--frozen), and this journal's "
                             "map is one of features");
  know_robots();
  if (journal_ && options_.clock)
    go_on_in_time(std::max(map_.last_utime, newest_utime(journal_->earlier_segments())));
  const std::string& journalled = map_.estimator().configuration().toml;
  if (!options_.toml.empty() && !map_alike(options_.toml, journalled)) {
    throw std::runtime_error(options_.journal_directory +
                             ": this journal was begun with another configuration; give that or none, or "
                             "another directory");
  }
  const bool withheld =
      parse_server_configuration(journalled, "the journal's configuration").authentication.withheld;
  if (!authentication_.is_required() && (withheld || has_signed_segments())) {
    throw std::runtime_error(
        options_.journal_directory +
        ": this journal's senders sign; give the configuration with their keys ([auth]), "
        "or begin another journal");
  }
}

/// Keys may have come with a later start than the journal's first.
bool LiveServer::has_signed_segments() const {
  const auto segments = list_journal(options_.journal_directory).segments;
  return std::ranges::any_of(segments,
                             [](const auto& segment) { return begins_with_counters(segment.second); });
}

/// Messages that come meanwhile wait in the inbox.
void LiveServer::recover() {
  tell_journal_found();
  const Clock::time_point start = Clock::now();
  Clock::time_point reported = start;
  bool more = true;
  while (more && !is_past(handling_share)) {
    more = recovery_->step(map_);
    count_inbox_drops();
    record_drops_if_due();
    if (Clock::now() - reported < recovery_report_interval) continue;
    reported = Clock::now();
    say(LogLevel::info, "recovering",
        {{"percent", std::to_string(static_cast<int>(100 * recovery_->progress()))}});
  }
  map_.monitor.forget_rates();
  know_robots();
  recovered_all_ = !more;
  const std::int64_t skipped_bytes = recovery_->skipped_bytes();
  const std::int64_t missing = recovery_->missing_events();
  say(skipped_bytes + missing > 0 || more ? LogLevel::warning : LogLevel::info,
      more ? "stopped before the journal was recovered" : "recovered",
      {{"events", std::to_string(map_.events)},
       {"of_a_snapshot", std::to_string(map_.events - recovery_->events())},
       {"damaged_bytes_skipped", std::to_string(skipped_bytes)},
       {"events_missing", std::to_string(missing)},
       {"seconds", std::to_string(seconds_of(Clock::now() - start))}});
  if (options_.frozen && recovered_all_) freeze();
  closure_log_.tell(map_.estimator().copy().closures, {});  // they were logged when they were new
}

void LiveServer::tell_journal_found() const {
  const std::int64_t torn_bytes = journal_ ? journal_->torn_bytes() : 0;
  LogFields fields = {{"directory", options_.journal_directory}};
  if (journal_) {
    fields.push_back({"segments", std::to_string(journal_->earlier_segments().size())});
    fields.push_back({"torn_bytes_cut", std::to_string(torn_bytes)});
  }
  say(torn_bytes > 0 ? LogLevel::warning : LogLevel::info, "recovering the journal", fields);
}

/// Those of the journal.
void LiveServer::know_robots() {
  const MapCopy map = map_.estimator().copy();
  admission_.know(map);
  for (const HealthRecord& robot : map.health) inbox_.reserve(robot.robot);
}

void LiveServer::freeze() {
  map_.engine.freeze();
  map_.last_utime = 0;
  const MapCopy map = map_.estimator().copy();
  say(LogLevel::info, "frozen: robots are localised, the map does not change and nothing is journalled",
      {{"patches", std::to_string(map.patches.size())},
       {"islands", std::to_string(map.graph.islands().size())},
       {"map_sha256", map_sha256(map)}});
}

/// After the journal's events, whatever the wall clock says now.
void LiveServer::go_on_in_time(std::int64_t journal_utime) {
  const std::int64_t behind_us = options_.clock->go_on_from(journal_utime);
  if (behind_us == 0) return;
  say(LogLevel::warning, "the wall clock is behind the journal; event time goes on from the journal's end",
      {{"seconds", std::to_string(1e-6 * static_cast<double>(behind_us))}});
}

}  // namespace isthmus
