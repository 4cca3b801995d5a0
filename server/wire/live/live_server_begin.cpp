// How a LiveServer begins: a journal of its own, or one that is found and goes on.

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "server/wire/journal/frames/spool_file.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/live/live_server.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

void raise_counters(const SignatureCounters& known, SignatureCounters& counters) {
  for (const auto& [stream, counter] : known) {
    std::int64_t& raised = counters.try_emplace(stream, counter).first->second;
    raised = std::max(raised, counter);
  }
}

}  // namespace

LiveServer::LiveServer(LiveOptions options, Inbox& inbox, Publish publish)
    : options_(std::move(options)),
      inbox_(inbox),
      publish_(std::move(publish)),
      answers_(publish_, options_.log),
      admission_(options_.admission) {
  if (!options_.mistakes) options_.mistakes = std::make_shared<Mistakes>();
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
  begin_goals();
}

/// Of a map that is being made: on a finished one there is nothing to explore.
void LiveServer::begin_goals() {
  if (options_.frozen || !options_.clock) return;
  const std::string& journalled = map_.estimator().configuration().toml;
  const std::string& toml = options_.toml.empty() ? journalled : options_.toml;
  const ServerConfiguration configuration = parse_server_configuration(toml, "configuration");
  if (!configuration.exploration.enabled) return;
  goals_ = std::make_unique<GoalPublisher>(publish_, configuration.exploration, options_.viewers.goals);
  for (const auto& [name, robot] : configuration.engine.robots)
    if (robot.declared) goals_->note_radius(name, robot.robot.footprint_radius_m);
}

void LiveServer::begin() {
  map_.last_utime = options_.clock ? options_.clock->now() : options_.start_utime;
  map_.choose_estimator(options_.toml);
  const Event configuration{map_.last_utime, ConfigurationEvent{options_.toml}};
  if (!journal(encode(configuration)) || (journal_ && journal_->waiting() > 0))
    throw std::runtime_error(options_.journal_directory + ": the disk refuses the journal's first event");
  take(configuration);
  map_.channels = channels_of(map_.estimator().configuration());
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

}  // namespace isthmus
