#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/journal/event_log.hpp"
#include "server/wire/journal/recovery/crash_guard.hpp"
#include "server/wire/journal/snapshot.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

struct RecoveryOptions {
  int last_segment = std::numeric_limits<int>::max();  ///< what follows it is not read
  /// Called for snapshots that cannot be used, and for parts of the journal that are damaged, missing or
  /// cannot be verified.
  std::function<void(const std::string&)> warn;
  /// Of the process that holds the journal: an event that it condemns is set aside. None: nothing is noted.
  CrashGuard* guard = nullptr;
  std::function<void(const std::string&)> report_set_aside;
  std::function<void(const Event&)> before_event;  ///< see handle_guarded
};

/// Makes the map that the events of a journal made: from the newest snapshot that can be read, and each event
/// after it in its order and with its time, as isthmus-replay reads them.
class Recovery {
 public:
  /// Throws std::runtime_error where the journal cannot be read, its segments do not belong together
  /// (view_journal), or the first of them are gone and no snapshot covers them.
  explicit Recovery(const std::string& directory, const RecoveryOptions& options = {});

  /// Whether there was a snapshot or an intact event.
  bool has_events() const { return snapshot_.has_value() || first_.has_value() || begun_; }

  /// The map of the snapshot, or an empty one of the journal's configuration; once, before the first `step`.
  /// Throws std::runtime_error where the configuration is wrong.
  ServedMap begin();

  /// The map takes the next event; false at the journal's end. Events too damaged to be read are counted as
  /// dropped.
  bool step(ServedMap& map);

  std::int64_t events() const { return events_; }  ///< read, those of the snapshot not counted
  std::int64_t skipped_bytes() const { return reader_.skipped_bytes(); }
  std::int64_t missing_events() const { return reader_.missing_events(); }  ///< that are known to be missing
  JournalPlace place() const { return reader_.place(); }                    ///< how far the journal was read
  double progress() const { return reader_.progress(); }
  const std::vector<TrajectoryPart>& trajectory() const { return trajectory_; }  ///< of the snapshot

 private:
  std::optional<Message> next();
  void take(ServedMap& map, const Message& message);

  void set_aside(ServedMap& map, const Message& message, const std::string& robot);

  std::string directory_;
  RecoveryOptions options_;
  SetAsideEvents set_aside_;
  std::optional<Snapshot> snapshot_;  ///< until it is begun with
  std::vector<TrajectoryPart> trajectory_;
  EventLogReader reader_;
  std::optional<Message> first_;  ///< until it is taken
  bool begun_ = false;
  std::int64_t events_ = 0;
};

}  // namespace isthmus
