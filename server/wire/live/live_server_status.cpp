// What a LiveServer tells at intervals: its status, the map, meetings, closures; and which drops the journal
// records.

#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>

#include "server/wire/live/live_server.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/watch/metrics.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

/// In another unit, any clock is years off.
void forget_clock(const std::string& robot, std::vector<LiveWarning>& warnings) {
  std::erase_if(warnings,
                [&](const LiveWarning& one) { return one.robot == robot && one.kind.starts_with("clock_"); });
}

}  // namespace

void LiveServer::publish_status_if_due() {
  const Clock::duration elapsed = Clock::now() - last_status_;
  if (elapsed < options_.status_interval) return;
  last_status_ += elapsed;
  tell_clock_step();
  const auto map = std::make_shared<const MapCopy>(map_.estimator().copy());
  const std::int64_t utime = options_.clock ? options_.clock->now() : map_.last_utime;
  status_t status = map_.monitor.status(*map, server_counters(), utime, seconds_of(elapsed));
  update_warnings(*map, status);
  const std::vector<std::uint8_t> bytes = encoded(status);
  options_.mistakes->sent_status(bytes);
  publish_("ISTHMUS_STATUS", bytes);
  if (options_.metrics) options_.metrics(metrics_text(status));
  if (options_.viewers.map) options_.viewers.map(map, status, latency_.quantile_s(0.99));
  if (const auto rendezvous = rendezvous_.due(*map, utime, last_status_))
    publish_("ISTHMUS_RENDEZVOUS", encoded(*rendezvous));
  closure_log_.tell(map->closures, options_.log);
  if (options_.questions) options_.questions->offer(map, utime);
  if (goals_) goals_->offer(map, utime);
  map_publisher_->offer(map, utime);
  keep_snapshots();
}

/// Of health, of what clients do wrong, and of the map itself, of which some patches are looked at each time.
void LiveServer::update_warnings(const MapCopy& map, status_t& status) {
  std::vector<LiveWarning> now = health_warnings_of(map);
  for (LiveWarning& lost : warnings_of_lost(map_.estimator().lost_robots())) now.push_back(std::move(lost));
  for (LiveWarning& lost : warnings_of_annotations(map.annotations)) now.push_back(std::move(lost));
  for (LiveWarning& mistake : options_.mistakes->warnings()) {
    if (mistake.kind == word(Mistake::wrong_time_unit)) forget_clock(mistake.robot, now);
    now.push_back(std::move(mistake));
  }
  constexpr std::size_t patches_looked_at = 16;
  self_check_.look_at(map, patches_looked_at);
  for (LiveWarning& of_map : warnings_of_contradictions(self_check_.found(map)))
    now.push_back(std::move(of_map));
  warnings_.update(std::move(now), status.utime, options_.log);
  for (const LiveWarning& warning : warnings_.current()) status.warnings.push_back(warning_message(warning));
  status.nwarnings = static_cast<std::int32_t>(status.warnings.size());
}

void LiveServer::note_mistakes(const Message& message, DropReason reason) {
  if (const std::optional<Channel> channel = find_channel(map_.channels, message.channel))
    options_.mistakes->note(*channel, message.bytes, reason, message.utime);
}

ServerCounters LiveServer::server_counters() const {
  ServerCounters counters;
  counters.queued = static_cast<std::int32_t>(inbox_.size());
  if (journal_) {
    counters.journal_bytes = journal_->bytes();
    counters.journal_failures = journal_->failures();
    counters.journal_waiting = static_cast<std::int64_t>(journal_->waiting());
  }
  counters.clock_steps = clock_steps_;
  if (options_.questions) counters.questions = options_.questions->counts();
  if (options_.publish_failures) counters.publish_failures = options_.publish_failures();
  return counters;
}

void LiveServer::tell_clock_step() {
  const std::optional<std::int64_t> step_us = options_.clock ? options_.clock->take_step() : std::nullopt;
  if (!step_us) return;
  clock_steps_ += 1;
  say(LogLevel::warning,
      *step_us > 0 ? "the wall clock was set forward; event time goes on as it was"
                   : "the wall clock was set back; event time goes on as it was",
      {{"seconds", std::to_string(1e-6 * static_cast<double>(std::abs(*step_us)))}});
}

/// In one record for as long as a status: the journal need not grow with each message of a flood.
void LiveServer::record_drops_if_due() {
  if (!settlement_) return;
  settlement_->settle();
  const Clock::time_point now = Clock::now();
  if (now - drops_recorded_ < options_.status_interval) return;
  drops_recorded_ = now;
  settlement_->record_drops(map_.last_utime);
}

void LiveServer::keep_snapshots() {
  if (!journal_ || !options_.snapshots) return;
  if (!snapshots_) {
    snapshots_ = std::make_unique<SnapshotProcess>(
        options_.journal_directory, options_.keep_snapshots, options_.keep_segments,
        [this](const std::string& text) { say(LogLevel::warning, text, {}); });
  }
  if (std::exchange(closed_segments_, journal_->segment() - 1) < journal_->segment() - 1)
    snapshots_->segment_closed();
  snapshots_->poll();
}

}  // namespace isthmus
