#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/event_log.hpp"
#include "server/wire/message.hpp"
#include "server/wire/snapshot.hpp"

namespace isthmus {

struct RecoveryOptions {
  int last_segment = std::numeric_limits<int>::max();  ///< what follows it is not read
  std::function<void(const std::string&)> warn;        ///< told of snapshots that are of no use
};

/// Makes the map that the events of a journal made: from the newest snapshot that can be read, and each event
/// after it in its order and with its time, as isthmus-replay reads them.
class Recovery {
 public:
  /// Throws std::runtime_error where the journal cannot be read, or its first segments are gone and no
  /// snapshot stands for them.
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
  double progress() const { return reader_.progress(); }
  int snapshot_segment() const {
    return snapshot_segment_;
  }  ///< that the snapshot ends with; 0: none was used
  const std::vector<TrajectoryPart>& trajectory() const { return trajectory_; }  ///< of the snapshot

 private:
  void take(ServedMap& map, const Message& message);

  int snapshot_segment_ = 0;
  std::optional<Snapshot> snapshot_;  ///< until it is begun with
  std::vector<TrajectoryPart> trajectory_;
  EventLogReader reader_;
  std::optional<Message> first_;  ///< until it is taken
  bool begun_ = false;
  std::int64_t events_ = 0;
};

}  // namespace isthmus
