#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/wire/file_bytes.hpp"

namespace isthmus {

/// The directory of a journal's segments, journal-000001.lcm, ..., held for one process as long as it lives.
class JournalDirectory {
 public:
  /// Makes the directory where missing. Throws std::runtime_error naming it and the reason: it cannot be made
  /// or read, another process holds it, or it holds logs that are no segments.
  explicit JournalDirectory(std::string path);

  const std::string& path() const { return path_; }
  /// In their order; those that were there at first.
  const std::vector<std::string>& segments() const { return segments_; }

  /// Cuts what follows the last intact event of the last segment, as a process or a machine that stopped
  /// within a write leaves it. Returns the bytes cut. Throws std::runtime_error where that cannot be done.
  std::int64_t cut_torn_tail();

  /// The number of the last segment that was there at first; 0: none.
  int last_segment() const { return last_segment_; }
  /// A new file for appending to. Returns 0 or errno.
  int create_segment(int number, FileHandle& file) const;

  /// New segments' names are on the disk. Returns 0 or errno. Any thread.
  int sync() const;

 private:
  void list_segments();

  std::string path_;
  FileHandle directory_;  ///< locked
  std::vector<std::string> segments_;
  int last_segment_ = 0;  ///< its number; 0: none
};

}  // namespace isthmus
