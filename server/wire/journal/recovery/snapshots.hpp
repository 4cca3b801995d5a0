#pragma once

#include <functional>
#include <optional>
#include <string>

namespace isthmus {

struct SnapshotPolicy {
  /// Closed segments that stay although a snapshot holds what they say; none: all of them.
  std::optional<int> keep_segments;
  /// For another process that makes them; else they are left to it.
  bool wait = false;
  std::function<void(const std::string&)> warn;
};

struct SnapshotsMade {
  int written = 0;
  int last_segment = 0;  ///< that the newest snapshot ends with; 0: there is none
  int pruned_segments = 0;
  bool busy = false;  ///< another process makes them: nothing was done
};

/// Brings the snapshots of a journal up to its last closed segment: all but the one that is being written.
/// It reads and writes beside the server that holds the journal, and does nothing where another process is at
/// it. The two newest snapshots stay; segments are pruned, where the policy says so, once the older of the
/// two holds them. Throws std::runtime_error naming file and reason.
SnapshotsMade update_snapshots(const std::string& directory, const SnapshotPolicy& policy = {});

}  // namespace isthmus
