#include "server/wire/journal/recovery/recovery.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "server/wire/journal/drop_record.hpp"
#include "server/wire/journal/journal_files.hpp"

namespace isthmus {
namespace {

/// Whether it was made without the events that are set aside now.
bool knows_set_aside(const Snapshot& snapshot, const JournalView& journal) {
  std::vector<std::int64_t> before_its_end;
  for (const auto& [sequence, event] : journal.set_aside) {
    if (sequence < snapshot.place.next_sequence) before_its_end.push_back(sequence);
  }
  return snapshot.map.set_aside == before_its_end;
}

/// Why a snapshot cannot be used for the journal; empty where it can.
std::string why_unfit(const Snapshot& snapshot, const JournalView& journal, int number) {
  std::string foreign = why_foreign(snapshot.place, journal, number);
  if (foreign.empty() && !knows_set_aside(snapshot, journal)) return "was made before events were set aside";
  return foreign;
}

/// The newest snapshot that can be used.
std::optional<Snapshot> newest_snapshot(const JournalView& journal, const RecoveryOptions& options) {
  for (auto file = journal.snapshots.rbegin(); file != journal.snapshots.rend(); ++file) {
    const auto& [number, path] = *file;
    if (number > options.last_segment) continue;
    try {
      Snapshot snapshot = read_snapshot(path);
      const std::string unfit = why_unfit(snapshot, journal, number);
      if (!unfit.empty()) throw std::runtime_error(std::string(path).append(": ").append(unfit));
      return snapshot;
    } catch (const std::exception& error) {
      if (options.warn) options.warn(std::string(error.what()) + "; an older one, or all events, must do");
    }
  }
  return std::nullopt;
}

}  // namespace

Recovery::Recovery(const std::string& directory, const RecoveryOptions& options)
    : directory_(directory), options_(options), reader_(JournalView(), {}) {
  const JournalView journal = view_journal(directory);
  set_aside_ = journal.set_aside;
  snapshot_ = newest_snapshot(journal, options);
  const JournalPlace from = snapshot_ ? snapshot_->place : JournalPlace();
  if (snapshot_) trajectory_ = snapshot_->trajectory;
  if (!journal.segments.empty() && journal.segments.front().number > from.segment + 1)
    throw std::runtime_error(segment_path(directory, journal.segments.front().number - 1) +
                             ": is gone, and no snapshot stands for it and those before it");
  reader_ = EventLogReader(journal, from, options.last_segment);
  first_ = next();
}

std::optional<Message> Recovery::next() {
  std::optional<Message> message = reader_.next();
  for (const std::string& warning : reader_.take_warnings())
    if (options_.warn) options_.warn(warning);
  return message;
}

ServedMap Recovery::begin() {
  begun_ = has_events();
  ServedMap map;
  if (snapshot_) {
    map = std::move(snapshot_->map);
    snapshot_.reset();
    return map;
  }
  if (!first_) return map;
  const Decoded decoded = decode(map.channels, first_->channel, first_->bytes, first_->utime);
  if (!decoded.event || !std::holds_alternative<ConfigurationEvent>(decoded.event->body)) return map;
  parse_server_configuration(std::get<ConfigurationEvent>(decoded.event->body).toml,
                             reader_.file() + ": its configuration");
  take(map, *std::exchange(first_, std::nullopt));
  return map;
}

bool Recovery::step(ServedMap& map) {
  const std::optional<Message> message = first_ ? std::exchange(first_, std::nullopt) : next();
  if (!message) return false;
  take(map, *message);
  return true;
}

void Recovery::take(ServedMap& map, const Message& message) {
  ++events_;
  ++map.events;
  if (const std::optional<Drops> drops = read_drops(message)) {
    if (set_aside_.contains(message.sequence)) map.set_aside.push_back(message.sequence);
    return count_drops(map.estimator(), *drops);
  }
  const Decoded decoded = decode(map.channels, message.channel, message.bytes, message.utime);
  if (decoded.event && options_.guard && options_.guard->is_condemned(message.sequence)) {
    set_aside(map, message, decoded.robot);
  } else if (decoded.event) {
    map.last_utime = std::max(map.last_utime, message.utime);
    if (const auto* configuration = std::get_if<ConfigurationEvent>(&decoded.event->body);
        configuration && map.events == 1)
      map.choose_estimator(configuration->toml);
    const Outcome outcome = handle_guarded(options_.guard, message.sequence, map.estimator(), *decoded.event,
                                           options_.before_event);
    for (const RobotPose& pose : outcome.poses) map.monitor.answered(pose);
    if (std::holds_alternative<ConfigurationEvent>(decoded.event->body))
      map.channels = channels_of(map.estimator().configuration());
  } else if (decoded.ours) {
    map.estimator().count_dropped(decoded.robot, decoded.reason, 1);
  }
}

/// As every reader of the journal does from now on.
void Recovery::set_aside(ServedMap& map, const Message& message, const std::string& robot) {
  set_aside_[message.sequence] = {message.utime, robot, message.channel,
                                  "two servers ended while they took it"};
  write_set_aside(directory_, set_aside_);
  options_.guard->acquit();
  map.set_aside.push_back(message.sequence);
  map.estimator().count_dropped(robot, DropReason::set_aside, 1);
  if (options_.report_set_aside)
    options_.report_set_aside("event " + std::to_string(message.sequence) + " of the journal on " +
                              message.channel + " is set aside: two servers ended while they took it");
}

}  // namespace isthmus
