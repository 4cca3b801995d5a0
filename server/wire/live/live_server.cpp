#include "server/wire/live/live_server.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "server/output/output.hpp"
#include "server/wire/journal/drop_record.hpp"
#include "server/wire/journal/frames/spool_file.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/watch/metrics.hpp"

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
constexpr double handling_share = 0.5;  // of the time to stop in

/// Of the last events that segments of a journal hold; 0: they hold none.
std::int64_t newest_utime(const std::vector<JournalSegment>& segments) {
  std::int64_t newest = 0;
  for (auto segment = segments.rbegin(); segment != segments.rend() && newest == 0; ++segment) {
    EventLogReader reader(segment->path);
    while (const std::optional<Message> message = reader.next()) newest = std::max(newest, message->utime);
  }
  return newest;
}

void raise_counters(const SignatureCounters& known, SignatureCounters& counters) {
  for (const auto& [stream, counter] : known) {
    std::int64_t& raised = counters.try_emplace(stream, counter).first->second;
    raised = std::max(raised, counter);
  }
}

bool asks_for_map(const Event& event) {
  const auto* command = std::get_if<CommandEvent>(&event.body);
  return command && command->verb == Verb::send_map;
}

}  // namespace

LiveServer::LiveServer(LiveOptions options, Inbox& inbox, Publish publish)
    : options_(std::move(options)),
      inbox_(inbox),
      publish_(std::move(publish)),
      admission_(options_.admission) {
  authentication_ = parse_server_configuration(options_.toml, "configuration").authentication;
  if (authentication_.withheld) throw std::runtime_error("configuration: a key in [auth] is empty");
  options_.toml = without_keys(options_.toml);
  parse_server_configuration(options_.toml, "configuration without its keys");
  start_ = last_event_ = last_status_ = drops_recorded_ = Clock::now();
  if (options_.frozen) {
    recovery_ = std::make_unique<Recovery>(options_.journal_directory, recovery_options());
    if (!recovery_->has_events())
      throw std::runtime_error(options_.journal_directory + ": holds no event of a journal to make a map of");
  } else if (!options_.journal_directory.empty()) {
    journal_ = std::make_unique<Journal>(options_.journal_directory, options_.journal);
    begin_guard();
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
  if (journal_) begin_spool();
  map_publisher_ = std::make_unique<MapPublisher>(publish_, options_.map);
}

void LiveServer::begin() {
  map_.last_utime = options_.clock ? options_.clock->now() : options_.start_utime;
  const Event configuration{map_.last_utime, ConfigurationEvent{options_.toml}};
  if (!journal(encode(configuration)) || (journal_ && journal_->waiting() > 0))
    throw std::runtime_error(options_.journal_directory + ": the disk refuses the journal's first event");
  take(configuration);
  map_.channels = channels_of(map_.engine.configuration());
}

void LiveServer::begin_guard() {
  try {
    guard_ = std::make_unique<CrashGuard>(options_.journal_directory);
  } catch (const std::runtime_error& error) {
    say(LogLevel::warning, "an event that brings the server down will not be set aside",
        {{"reason", error.what()}});
    return;
  }
  if (guard_->suspect() < 0) return;
  say(LogLevel::warning, "a server ended while it took an event",
      {{"event", std::to_string(guard_->suspect())}, {"running", std::to_string(guard_->ends())}});
}

/// Goes on with what an earlier server had received and not handled.
void LiveServer::begin_spool() {
  const std::string& directory = options_.journal_directory;
  std::set<std::int64_t> settled;
  if (const std::optional<int> first = first_segment_of_spool(directory))
    settled = settled_messages(journal_->earlier_segments(), *first);
  SpoolOptions options;
  options.disk = options_.journal.disk;
  options.journal_segment = journal_->segment();
  options.report = options_.journal.report;
  options.next_number = journal_->last_received() + 1;
  const std::int64_t since_utime = options_.clock ? options_.clock->now() : options_.start_utime;
  options.acknowledge = [this, since_utime](const Receipts& receipts) {
    const std::int64_t utime = options_.clock ? options_.clock->now() : since_utime;
    publish_("ISTHMUS_RECEIVED", encoded(receipts.message(utime, since_utime)));
  };
  spool_ = std::make_shared<Spool>(directory, settled, options);
  settlement_ = std::make_unique<Settlement>(*journal_, *spool_);
  raise_counters(spool_->counters(), counters_);
  std::vector<Message> found = spool_->take_found();
  if (!found.empty() || spool_->lost_bytes() > 0) {
    say(spool_->lost_bytes() > 0 ? LogLevel::warning : LogLevel::info, "received before and not handled",
        {{"messages", std::to_string(found.size())}, {"torn_bytes", std::to_string(spool_->lost_bytes())}});
  }
  for (Message& message : found) {
    if (options_.clock) options_.clock->go_on_from(message.utime);
    const std::optional<Channel> channel = find_channel(map_.channels, message.channel);
    if (channel && channel->input == Input::robot && channel->valid) inbox_.introduce(channel->robot);
    inbox_.put_back(channel ? channel->robot : "", channel && channel->input == Input::scan,
                    std::move(message));
  }
  inbox_.keep_in(spool_);
}

RecoveryOptions LiveServer::recovery_options() const {
  RecoveryOptions options;
  if (journal_) options.last_segment = journal_->segment() - 1;
  options.guard = guard_.get();
  options.report_set_aside = [this](const std::string& text) { say(LogLevel::error, text, {}); };
  options.before_event = options_.before_event;
  options.warn = [this](const std::string& warning) { say(LogLevel::warning, warning, {}); };
  return options;
}

/// Those that the journal told of.
void LiveServer::know_robots() {
  const MapCopy map = map_.engine.copy();
  admission_.know(map);
  for (const HealthRecord& robot : map.health) inbox_.reserve(robot.robot);
}

/// From now on it is known who is on the map.
void LiveServer::refuse_strangers() {
  for (const auto& [name, robot] : map_.engine.configuration().robots) inbox_.reserve(name);
  inbox_.refuse_strangers();
}

void LiveServer::begin_recovery() {
  map_ = recovery_->begin();
  know_robots();
  if (journal_ && options_.clock)
    go_on_in_time(std::max(map_.last_utime, newest_utime(journal_->earlier_segments())));
  const std::string& journalled = map_.engine.configuration().toml;
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

LiveServer::~LiveServer() { inbox_.keep_in(nullptr); }

void LiveServer::run() {
  if (recovery_ && recovery_->has_events()) recover();
  recovery_.reset();
  refuse_strangers();
  keep_snapshots();
  while (!inbox_.finished() && !is_past(handling_share)) {
    if (std::optional<Message> message = inbox_.pop(options_.tick_interval)) {
      handle(std::move(*message));
    } else {
      if (journal_) journal_->write_waiting();
    }
    tick_if_due();  // messages that are refused are none of the engine's, however many
    count_inbox_drops();
    record_drops_if_due();
    publish_status_if_due();
  }
  count_left_over();
  end();
}

/// Messages that come meanwhile wait in the inbox.
void LiveServer::recover() {
  tell_journal_found();
  const Clock::time_point start = Clock::now();
  Clock::time_point told = start;
  bool more = true;
  while (more && !is_past(handling_share)) {
    more = recovery_->step(map_);
    count_inbox_drops();
    record_drops_if_due();
    if (Clock::now() - told < recovery_report_interval) continue;
    told = Clock::now();
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
       {"seconds", std::to_string(seconds(Clock::now() - start))}});
  if (options_.frozen && recovered_all_) freeze();
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
  const Decoded decoded = decode(map_.channels, message.channel, message.bytes, message.utime);
  Dropped one{1, {}};
  if (message.received >= 0) one.received.push_back(message.received);
  if (!decoded.ours) return drop("", DropReason::bad_channel, {0, one.received});  // not counted
  if (!decoded.event || is_own(*decoded.event))
    return drop(decoded.robot, decoded.event ? DropReason::bad_channel : decoded.reason, one);
  if (const DropReason reason = refusal(*decoded.event); reason != DropReason::none)
    return drop(decoded.robot, reason, one);  // never an order
  map_.last_utime = message.utime;
  map_.monitor.heard(decoded.robot, message.utime);
  if (!journal(message)) {
    tell_sender(*decoded.event, DropReason::journal_full);
    return drop(decoded.robot, DropReason::journal_full, one);
  }
  tell_sender(*decoded.event, take(*decoded.event));
  reserve_queue(*decoded.event);
  if (asks_for_map(*decoded.event)) map_publisher_->request_whole();
}

/// Why the map does not take an event, if so. What is refused is not journalled.
DropReason LiveServer::refusal(const Event& event) {
  return map_.engine.is_stranger(event) ? DropReason::unknown_robot : admission_.admit(event);
}

/// Robots that the map knows; admission bounds their number.
void LiveServer::reserve_queue(const Event& event) {
  if (const auto* robot = std::get_if<RobotEvent>(&event.body)) inbox_.reserve(robot->robot);
}

void LiveServer::tell_sender(const Event& event, DropReason reason) const {
  const auto* order = std::get_if<CommandEvent>(&event.body);
  if (order && options_.viewers.order) options_.viewers.order(*order, reason);
}

DropReason LiveServer::take(const Event& event) {
  const Clock::time_point start = Clock::now();
  const Outcome outcome = handle_guarded(guard_.get(), journal_ ? journal_->last_sequence() : -1, map_.engine,
                                         event, options_.before_event);
  last_event_ = Clock::now();
  latency_.add(seconds(last_event_ - start));
  publish_poses(outcome);
  return outcome.drop_reason;
}

/// False: the engine must not have the event, or its map would be another than a replay's.
bool LiveServer::journal(const Message& message) {
  if (!journal_) return true;
  if (!journal_->append(message)) return false;
  if (settlement_) settlement_->journalled(message);
  return true;
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

void LiveServer::publish_poses(const Outcome& outcome) {
  for (const RobotPose& pose : outcome.poses) {
    map_.monitor.answered(pose);
    if (options_.viewers.pose) options_.viewers.pose(pose);
    publish_(pose.robot + "_POSE", encoded(pose_message(pose)));
  }
}

void LiveServer::tick_if_due() {
  if (!options_.clock || Clock::now() - last_event_ < options_.tick_interval) return;
  if (!map_.engine.has_queued_work()) return;
  map_.last_utime = std::max(map_.last_utime, options_.clock->now());
  const Event tick{map_.last_utime, TickEvent{}};
  if (journal(encode(tick))) take(tick);
}

/// After the journal's events, whatever the wall clock says now.
void LiveServer::go_on_in_time(std::int64_t journal_utime) {
  const std::int64_t behind_us = options_.clock->go_on_from(journal_utime);
  if (behind_us == 0) return;
  say(LogLevel::warning, "the wall clock is behind the journal; event time goes on from the journal's end",
      {{"seconds", std::to_string(1e-6 * static_cast<double>(behind_us))}});
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

void LiveServer::drop(const std::string& robot, DropReason reason, const Dropped& dropped) {
  count_drops(map_.engine, {{robot, {{reason, dropped}}}});
  if (settlement_) settlement_->dropped(robot, reason, dropped);
}

void LiveServer::count_inbox_drops() {
  for (const auto& [robot, reasons] : inbox_.take_drops()) {
    for (const auto& [reason, dropped] : reasons) drop(robot, reason, dropped);
  }
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

void LiveServer::publish_status_if_due() {
  const Clock::duration elapsed = Clock::now() - last_status_;
  if (elapsed < options_.status_interval) return;
  last_status_ += elapsed;
  tell_clock_step();
  const auto map = std::make_shared<const MapCopy>(map_.engine.copy());
  const std::int64_t utime = options_.clock ? options_.clock->now() : map_.last_utime;
  const status_t status = map_.monitor.status(*map, server_counters(), utime, seconds(elapsed));
  publish_("ISTHMUS_STATUS", encoded(status));
  if (options_.metrics) options_.metrics(metrics_text(status));
  if (options_.viewers.map) options_.viewers.map(map, status, latency_.quantile_s(0.99));
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
  counters.clock_steps = clock_steps_;
  if (options_.publish_failures) counters.publish_failures = options_.publish_failures();
  return counters;
}

void LiveServer::say(LogLevel level, std::string_view message, const LogFields& fields) const {
  if (options_.log) options_.log(level, message, fields);
}

void LiveServer::write_results(bool finished) {
  if (options_.output_directory.empty()) return;
  RunCost cost;
  cost.finished = finished;
  cost.finish_s = finish_s_;
  cost.wall_s = seconds(Clock::now() - start_);
  cost.cpu_s = process_cpu_s();
  cost.peak_rss_mb = process_peak_rss_mb();
  cost.event_latency = latency_;
  write_outputs(map_.engine.copy(), cost, options_.output_directory);
}

}  // namespace isthmus
