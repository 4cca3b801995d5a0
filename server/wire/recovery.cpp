#include "server/wire/recovery.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "server/wire/journal_files.hpp"

namespace isthmus {
namespace {

struct Start {
  int segment = 0;  ///< the last one that the snapshot holds; 0: there is none
  std::optional<Snapshot> snapshot;
};

Start newest_snapshot(const JournalFiles& files, const RecoveryOptions& options) {
  for (auto file = files.snapshots.rbegin(); file != files.snapshots.rend(); ++file) {
    if (file->first > options.last_segment) continue;
    try {
      return {file->first, read_snapshot(file->second)};
    } catch (const std::exception& error) {
      if (options.warn) options.warn(std::string(error.what()) + "; an older one, or all events, must do");
    }
  }
  return {};
}

/// Those after a snapshot. Throws std::runtime_error where some are missing.
std::vector<std::string> segments_after(const std::string& directory, const JournalFiles& files, int snapshot,
                                        int last) {
  std::vector<std::string> paths;
  int expected = snapshot + 1;
  for (const auto& [number, path] : files.segments) {
    if (number <= snapshot || number > last) continue;
    if (number != expected) {
      throw std::runtime_error(directory + ": " + segment_path("", expected) +
                               " is gone, and no snapshot stands for it");
    }
    paths.push_back(path);
    expected = number + 1;
  }
  return paths;
}

}  // namespace

Recovery::Recovery(const std::string& directory, const RecoveryOptions& options)
    : reader_(std::vector<std::string>()) {
  const JournalFiles files = list_journal(directory);
  Start start = newest_snapshot(files, options);
  snapshot_segment_ = start.segment;
  snapshot_ = std::move(start.snapshot);
  if (snapshot_) trajectory_ = snapshot_->trajectory;
  reader_ = EventLogReader(segments_after(directory, files, snapshot_segment_, options.last_segment));
  first_ = reader_.next();
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
  const Decoded decoded = decode(map.engine.configuration(), first_->channel, first_->bytes, first_->utime);
  if (!decoded.event || !std::holds_alternative<ConfigurationEvent>(decoded.event->body)) return map;
  const auto parsed = parse_configuration(std::get<ConfigurationEvent>(decoded.event->body).toml,
                                          reader_.file() + ": its configuration");
  if (const std::string* error = std::get_if<std::string>(&parsed)) throw std::runtime_error(*error);
  take(map, *std::exchange(first_, std::nullopt));
  return map;
}

bool Recovery::step(ServedMap& map) {
  const std::optional<Message> message = first_ ? std::exchange(first_, std::nullopt) : reader_.next();
  if (!message) return false;
  take(map, *message);
  return true;
}

void Recovery::take(ServedMap& map, const Message& message) {
  ++events_;
  ++map.events;
  const Decoded decoded = decode(map.engine.configuration(), message.channel, message.bytes, message.utime);
  if (decoded.event) {
    map.last_utime = std::max(map.last_utime, message.utime);
    for (const RobotPose& pose : map.engine.handle(*decoded.event).poses) map.monitor.answered(pose);
  } else if (decoded.ours) {
    map.engine.count_dropped(decoded.robot, decoded.reason);
  }
}

}  // namespace isthmus
