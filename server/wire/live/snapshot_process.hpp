#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace isthmus {

/// Runs isthmus-snapshot, which lies beside this program, on a journal: in a process of its own and at the
/// lowest priority, so that nobody waits for it. One at a time.
class SnapshotProcess {
 public:
  /// What is kept: see SnapshotPolicy.
  SnapshotProcess(std::string journal_directory, int keep_snapshots, std::optional<int> keep_segments,
                  std::function<void(const std::string&)> report);
  /// Leaves one that still runs to itself: what it writes is whole or not there.
  ~SnapshotProcess();
  SnapshotProcess(const SnapshotProcess&) = delete;
  SnapshotProcess& operator=(const SnapshotProcess&) = delete;

  /// Another segment is closed. Begins the process, or has it begun again when the one that runs is done.
  void segment_closed();
  /// To be called now and then: begins what waits, and reports how the last one ended where that was not
  /// well.
  void poll();

 private:
  void begin();

  std::string journal_directory_;
  int keep_snapshots_;
  std::optional<int> keep_segments_;
  std::function<void(const std::string&)> report_;
  pid_t process_ = 0;  ///< 0: none
  bool wanted_ = false;
};

}  // namespace isthmus
