#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <tuple>
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

/// Where a row is said to be instead, by the newer knowledge of what its robot had seen.
struct RowCorrection {
  std::uint64_t row = 0;
  PatchId patch;
  Pose patch_from_robot;

  auto members() { return std::tie(row, patch, patch_from_robot); }
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

  /// Rows [first, first + count), as corrected, fewer at the end. Thread-safe for rows flushed before.
  std::vector<TrajectoryRow> read(std::size_t first, std::size_t count) const;

  /// What is written stays as it is; a correction is kept beside it. It is to say the same place of the map
  /// as the row did, for whoever reads it with an older copy of the map.
  void correct(const RowCorrection& correction);
  /// By row.
  std::vector<RowCorrection> corrections() const;

 private:
  int file_ = -1;
  std::size_t size_ = 0;
  std::atomic<std::size_t> flushed_ = 0;  ///< rows in the file, for readers of other threads
  std::vector<TrajectoryRow> buffer_;
  mutable std::mutex correcting_;
  std::map<std::uint64_t, RowCorrection> corrections_;  ///< by row
};

}  // namespace isthmus
