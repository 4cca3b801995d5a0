#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "patches/manifold.hpp"

namespace isthmus {

/// Where a robot was at one scan: on the manifold, so that later fits carry the row along.
struct TrajectoryRow {
  std::int64_t utime = 0;
  std::int32_t session = 0;
  PatchId patch;
  Pose patch_from_robot;
};

/// All robots' rows in event order, spooled to an unlinked temporary file so that memory does not grow with
/// time. One writer; readers may read rows already flushed from another thread.
class TrajectoryStore {
 public:
  /// Throws std::runtime_error where no temporary file can be made ($TMPDIR, or /tmp).
  TrajectoryStore();
  ~TrajectoryStore();
  TrajectoryStore(const TrajectoryStore&) = delete;
  TrajectoryStore& operator=(const TrajectoryStore&) = delete;

  void append(const TrajectoryRow& row);
  /// Writes what is buffered, so that `read` sees it. Returns false when the disk refused it.
  bool flush();
  std::size_t size() const { return size_; }

  /// Rows [first, first + count), fewer at the end. Thread-safe for rows flushed before.
  std::vector<TrajectoryRow> read(std::size_t first, std::size_t count) const;

 private:
  int file_ = -1;
  std::size_t size_ = 0;
  std::atomic<std::size_t> flushed_ = 0;  ///< rows in the file, for readers of other threads
  std::vector<TrajectoryRow> buffer_;
};

}  // namespace isthmus
