#include "server/wire/live_server.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "server/output/output.hpp"
#include "server/wire/encoded.hpp"
#include "server/wire/message.hpp"
#include "server/wire/metrics.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

/// Configurations and ticks are the server's own entries in its journal: nobody may send them.
bool is_own(const Event& event) {
  return std::holds_alternative<ConfigurationEvent>(event.body) ||
         std::holds_alternative<TickEvent>(event.body);
}

constexpr std::chrono::seconds recovery_report_interval(5);

bool asks_for_map(const Event& event) {
  const auto* command = std::get_if<CommandEvent>(&event.body);
  return command && command->verb == "send_map";
}

}  // namespace

LiveServer::LiveServer(LiveOptions options, Inbox& inbox, Publish publish)
    : options_(std::move(options)),
      inbox_(inbox),
      publish_(std::move(publish)),
      admission_(options_.admission) {
  const auto parsed = parse_configuration(options_.toml, "configuration");
  if (const std::string* error = std::get_if<std::string>(&parsed)) throw std::runtime_error(*error);
  authentication_ = std::get<Configuration>(parsed).authentication;
  if (authentication_.withheld) throw std::runtime_error("configuration: a key in [auth] is empty");
  options_.toml = without_keys(options_.toml);
  const auto shown = parse_configuration(options_.toml, "configuration without its keys");
  if (const std::string* error = std::get_if<std::string>(&shown)) throw std::runtime_error(*error);
  start_ = last_event_ = last_status_ = Clock::now();
  if (options_.frozen) {
    recovery_ = std::make_unique<Recovery>(options_.journal_directory, recovery_options());
    if (!recovery_->has_events())
      throw std::runtime_error(options_.journal_directory + ": holds no event of a journal to make a map of");
  } else if (!options_.journal_directory.empty()) {
    journal_ = std::make_unique<Journal>(options_.journal_directory, options_.journal);
  }
  if (journal_ && !journal_->earlier_segments().empty())
    recovery_ = std::make_unique<Recovery>(options_.journal_directory, recovery_options());
  if (recovery_ && recovery_->has_events()) {
    begin_recovery();
  } else {
    begin();
  }
  if (!journal_ && authentication_.is_required())
    say(LogLevel::warning, "without a journal, what is signed can be taken again after a restart", {});
  if (journal_ && authentication_.is_required()) counters_ = journal_->count_signatures();
  map_publisher_ = std::make_unique<MapPublisher>(publish_, options_.map);
}

void LiveServer::begin() {
  map_.last_utime = options_.clock ? options_.clock() : options_.start_utime;
  const Event configuration{map_.last_utime, ConfigurationEvent{options_.toml}};
  if (!journal(encode(configuration)) || (journal_ && journal_->waiting() > 0))
    throw std::runtime_error(options_.journal_directory + ": the disk refuses the journal's first event");
  take(configuration);
}

RecoveryOptions LiveServer::recovery_options() const {
  RecoveryOptions options;
  options.warn = [this](const std::string& warning) { say(LogLevel::warning, warning, {}); };
  return options;
}

/// Those that the journal told of.
void LiveServer::know_robots() {
  const MapCopy map = map_.engine.copy();
  admission_.know(map);
  for (const HealthRecord& robot : map.health) inbox_.reserve(robot.robot);
}

void LiveServer::begin_recovery() {
  map_ = recovery_->begin();
  know_robots();
  const Configuration& configuration = map_.engine.configuration();
  if (!options_.toml.empty() && !map_alike(options_.toml, configuration.toml)) {
    throw std::runtime_error(options_.journal_directory +
                             ": this journal was begun with another configuration; give that or none, or "
                             "another directory");
  }
  if (options_.toml.empty() && configuration.authentication.withheld) {
    throw std::runtime_error(options_.journal_directory +
                             ": this journal's senders sign; give the configuration with their keys");
  }
}

LiveServer::~LiveServer() = default;

void LiveServer::run() {
  if (recovery_ && recovery_->has_events()) recover();
  recovery_.reset();
  keep_snapshots();
  while (!inbox_.finished()) {
    if (std::optional<Message> message = inbox_.pop(options_.tick_interval)) {
      handle(std::move(*message));
    } else {
      if (journal_) journal_->write_waiting();
      tick_if_due();
    }
    count_inbox_drops();
    publish_status_if_due();
  }
  publish_poses(map_.engine.finish());
  closure_log_.tell(map_.engine.copy().closures, options_.log);
  map_publisher_.reset();
  const std::string lost = finish_journal();
  if (!options_.output_directory.empty()) write_results();
  if (!lost.empty()) throw std::runtime_error(lost);
}

/// Messages that come meanwhile wait in the inbox.
void LiveServer::recover() {
  tell_journal_found();
  const Clock::time_point start = Clock::now();
  Clock::time_point told = start;
  while (recovery_->step(map_)) {
    if (Clock::now() - told < recovery_report_interval) continue;
    told = Clock::now();
    say(LogLevel::info, "recovering",
        {{"percent", std::to_string(static_cast<int>(100 * recovery_->progress()))}});
  }
  map_.monitor.forget_rates();
  know_robots();
  const std::int64_t skipped_bytes = recovery_->skipped_bytes();
  say(skipped_bytes > 0 ? LogLevel::warning : LogLevel::info, "recovered",
      {{"events", std::to_string(map_.events)},
       {"of_a_snapshot", std::to_string(map_.events - recovery_->events())},
       {"damaged_bytes_skipped", std::to_string(skipped_bytes)},
       {"seconds", std::to_string(seconds(Clock::now() - start))}});
  if (options_.frozen) freeze();
  closure_log_.tell(map_.engine.copy().closures, {});  // told when they were new
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

void LiveServer::freeze() {
  map_.engine.freeze();
  map_.last_utime = 0;
  const MapCopy map = map_.engine.copy();
  say(LogLevel::info, "frozen: robots are localised, the map does not change and nothing is journalled",
      {{"patches", std::to_string(map.patches.size())},
       {"islands", std::to_string(map.graph.islands().size())},
       {"map_sha256", map_sha256(map)}});
}

void LiveServer::handle(Message message) {
  message.utime = std::max(message.utime, map_.last_utime);
  const Decoded decoded = decode(map_.engine.configuration(), message.channel, message.bytes, message.utime);
  if (!decoded.ours) return;
  if (!decoded.event || is_own(*decoded.event)) {
    map_.engine.count_dropped(decoded.robot, decoded.event ? "bad_channel" : decoded.reason);
    return;
  }
  if (const std::string reason = admission_.admit(*decoded.event); !reason.empty()) {
    map_.engine.count_dropped(decoded.robot, reason);
    return;
  }
  map_.last_utime = message.utime;
  map_.monitor.heard(decoded.robot, message.utime);
  if (!journal(message)) {
    map_.engine.count_dropped(decoded.robot, "journal_full");
    return;
  }
  take(*decoded.event);
  reserve_queue(*decoded.event);
  if (asks_for_map(*decoded.event)) map_publisher_->request_whole();
}

/// Robots that the map knows; admission bounds their number.
void LiveServer::reserve_queue(const Event& event) {
  if (const auto* robot = std::get_if<RobotEvent>(&event.body)) inbox_.reserve(robot->robot);
}

void LiveServer::take(const Event& event) {
  const Clock::time_point start = Clock::now();
  const Outcome outcome = map_.engine.handle(event);
  last_event_ = Clock::now();
  latency_.add(seconds(last_event_ - start));
  publish_poses(outcome);
}

/// False: the engine must not have the event, or its map would be another than a replay's.
bool LiveServer::journal(const Message& message) { return !journal_ || journal_->append(message); }

/// What is to be said of events that the disk refused to the end; empty: none.
std::string LiveServer::finish_journal() {
  const std::size_t lost = journal_ ? journal_->finish() : 0;
  journal_.reset();
  if (lost == 0) return "";
  return options_.journal_directory + ": events that the disk refused to the end: " + std::to_string(lost) +
         "; the map has them, the journal does not";
}

void LiveServer::publish_poses(const Outcome& outcome) {
  for (const RobotPose& pose : outcome.poses) {
    map_.monitor.answered(pose);
    publish_(pose.robot + "_POSE", encoded(pose_message(pose)));
  }
}

void LiveServer::tick_if_due() {
  if (!options_.clock || !map_.engine.has_queued_work()) return;
  if (Clock::now() - last_event_ < options_.tick_interval) return;
  map_.last_utime = std::max(map_.last_utime, options_.clock());
  const Event tick{map_.last_utime, TickEvent{}};
  if (journal(encode(tick))) take(tick);
}

void LiveServer::count_inbox_drops() {
  for (const auto& [robot, reasons] : inbox_.take_drops()) {
    for (const auto& [reason, count] : reasons) {
      for (std::int64_t i = 0; i < count; ++i) map_.engine.count_dropped(robot, reason);
    }
  }
}

void LiveServer::publish_status_if_due() {
  const Clock::duration elapsed = Clock::now() - last_status_;
  if (elapsed < options_.status_interval) return;
  last_status_ += elapsed;
  const auto map = std::make_shared<const MapCopy>(map_.engine.copy());
  const std::int64_t utime = options_.clock ? options_.clock() : map_.last_utime;
  const status_t status = map_.monitor.status(*map, server_counters(), utime, seconds(elapsed));
  publish_("ISTHMUS_STATUS", encoded(status));
  if (options_.metrics) options_.metrics(metrics_text(status));
  if (const auto rendezvous = rendezvous_.due(*map, utime, last_status_))
    publish_("ISTHMUS_RENDEZVOUS", encoded(*rendezvous));
  closure_log_.tell(map->closures, options_.log);
  map_publisher_->offer(map, utime);
  keep_snapshots();
}

void LiveServer::keep_snapshots() {
  if (!journal_ || !options_.snapshots) return;
  if (!snapshots_) {
    snapshots_ = std::make_unique<SnapshotProcess>(
        options_.journal_directory, options_.keep_segments,
        [this](const std::string& text) { say(LogLevel::warning, text, {}); });
  }
  if (std::exchange(closed_segments_, journal_->segment() - 1) < journal_->segment() - 1)
    snapshots_->segment_closed();
  snapshots_->poll();
}

ServerCounters LiveServer::server_counters() const {
  ServerCounters counters;
  counters.queued = static_cast<std::int32_t>(inbox_.size());
  if (journal_) {
    counters.journal_bytes = journal_->bytes();
    counters.journal_failures = journal_->failures();
    counters.journal_waiting = static_cast<std::int64_t>(journal_->waiting());
  }
  if (options_.publish_failures) counters.publish_failures = options_.publish_failures();
  return counters;
}

void LiveServer::say(LogLevel level, std::string_view message, const LogFields& fields) const {
  if (options_.log) options_.log(level, message, fields);
}

void LiveServer::write_results() {
  RunCost cost;
  cost.wall_s = seconds(Clock::now() - start_);
  cost.cpu_s = process_cpu_s();
  cost.peak_rss_mb = process_peak_rss_mb();
  cost.event_latency = latency_;
  write_outputs(map_.engine.copy(), cost, options_.output_directory);
}

}  // namespace isthmus
