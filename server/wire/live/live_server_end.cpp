// How a LiveServer ends: in a bounded time, and never without results.

#include <optional>
#include <stdexcept>

#include "server/feature_maps/output/feature_files.hpp"
#include "server/output/output.hpp"
#include "server/wire/live/live_server.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

void LiveServer::stop_within(Clock::duration time) {
  stop_asked_ = Clock::now();
  deadline_ = stop_asked_ + time;
}

/// Whether so much of the time to stop in is over.
bool LiveServer::is_past(double share_of_time) const {
  const Clock::time_point deadline = deadline_;
  if (deadline == Clock::time_point::max()) return false;
  return Clock::now() >= stop_asked_ + share_of_time * (deadline - stop_asked_);
}

/// Messages that there was no time to handle. Those that the spool holds are handled after the next start.
void LiveServer::count_left_over() {
  std::size_t kept = 0;
  while (const std::optional<Message> message = inbox_.pop(std::chrono::milliseconds(0))) {
    if (spool_ && message->received >= 0) {
      ++kept;
      continue;
    }
    const Decoded decoded = decode(map_.channels, message->channel, message->bytes, message->utime);
    if (decoded.ours) map_.estimator().count_dropped(decoded.robot, DropReason::stopped, 1);
  }
  if (kept > 0)
    say(LogLevel::info, "received and not handled yet; the next start on this journal does",
        {{"messages", std::to_string(kept)}});
}

void LiveServer::end() {
  if (options_.questions) options_.questions->stop();
  goals_.reset();
  map_publisher_.reset();
  const std::string lost = finish_journal();
  const Clock::time_point begun = Clock::now();
  write_results(false);  // whatever comes
  const Clock::time_point written = Clock::now();
  const bool finished = finish_map(written - begun);
  finish_s_ = seconds_of(Clock::now() - written);
  closure_log_.tell(map_.estimator().copy().closures, options_.log);
  write_results(finished && recovered_all_);
  if (!lost.empty()) throw std::runtime_error(lost);
}

/// What is to be said of events that the disk refused to the end, or that were taken from it; empty: nothing.
std::string LiveServer::finish_journal() {
  if (!journal_) return "";
  settlement_->record_drops(map_.last_utime);
  const std::size_t lost = journal_->finish();
  const std::string incomplete = journal_->why_incomplete();
  settlement_->settle();
  settlement_.reset();
  spool_->finish();
  journal_.reset();
  if (!incomplete.empty()) return "the journal is not whole any more: " + incomplete;
  if (lost == 0) return "";
  return options_.journal_directory + ": events that the disk refused to the end: " + std::to_string(lost) +
         "; the map has them, the journal does not";
}

/// False: there was no time to finish it and write it once more.
bool LiveServer::finish_map(Clock::duration time_to_write) {
  constexpr int caution = 2;  // a finished map may take longer to write
  Outcome outcome;
  while (map_.estimator().finish_step(outcome)) {
    publish_poses(outcome);
    outcome.poses.clear();
    const Clock::time_point deadline = deadline_;
    if (deadline == Clock::time_point::max() || Clock::now() + caution * time_to_write < deadline) continue;
    say(LogLevel::warning, "no time to finish the map; isthmus-replay makes the finished one of the journal",
        {{"left", std::string(map_.estimator().finishing())}});
    return false;
  }
  publish_poses(outcome);
  return true;
}

void LiveServer::write_results(bool finished) {
  if (options_.output_directory.empty()) return;
  RunCost cost;
  cost.finished = finished;
  cost.finish_s = finish_s_;
  cost.wall_s = seconds_of(Clock::now() - start_);
  cost.cpu_s = process_cpu_s();
  cost.peak_rss_mb = process_peak_rss_mb();
  cost.event_latency = latency_;
  if (map_.features)
    write_outputs(map_.features->maps(), cost, options_.output_directory);
  else
    write_outputs(map_.engine.copy(), cost, options_.output_directory);
}

}  // namespace isthmus
