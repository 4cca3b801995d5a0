#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace isthmus {

/// Two at least: should the newest not be readable, the one before it must do.
inline constexpr int least_kept_snapshots = 2;

struct SnapshotPolicy {
  /// So many stay: the newest two, the oldest, and ever fewer the older they are.
  int keep_snapshots = 10;
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
/// it. Segments are pruned, where the policy says so, once the older of the two newest snapshots holds them.
/// Throws std::runtime_error naming file and reason; of a directory that holds no journal, nothing is
/// touched.
SnapshotsMade update_snapshots(const std::string& directory, const SnapshotPolicy& policy = {});

/// The snapshot to do without, of those after these segments (rising): such that what is left lies the closer
/// the newer it is, and covers all there was. Nothing where there are no more than `keep`.
std::optional<int> dispensable_snapshot(const std::vector<int>& segments, int keep);

}  // namespace isthmus
