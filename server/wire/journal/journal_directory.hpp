#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "server/wire/file/file_bytes.hpp"
#include "server/wire/journal/journal_view.hpp"

namespace isthmus {

/// The directory of a journal's segments, journal-000001.lcm, ..., held for one process as long as it lives.
class JournalDirectory {
 public:
  /// Makes the directory where missing. Throws std::runtime_error naming it or a file, and the reason: it
  /// cannot be made or read, another process holds it, its segments do not belong together (view_journal), or
  /// they are of a journal without checks, which cannot be continued.
  explicit JournalDirectory(std::string path);

  const std::string& path() const { return path_; }
  /// What the directory held at the beginning.
  const JournalView& found() const { return found_; }

  /// Truncates an event at the end of the last segment that was partly written when process or machine
  /// stopped; other damage stays. Returns the bytes removed. Throws std::runtime_error where that
  /// cannot be done.
  std::int64_t cut_torn_tail();
  /// Where the journal continues, after truncation.
  const JournalPlace& place() const { return place_; }

  /// A new file for appending to. Returns 0 or errno.
  int create_segment(int number, FileHandle& file) const;
  void remove_segment(int number) const;
  /// Whether a segment's file still has its name in the directory. Any thread.
  bool names(int number, const FileHandle& file) const;
  /// Writes a segment again that has lost its name, from its file, which is still open, and makes the
  /// directory again where that is gone too. Returns 0 or errno; EEXIST: another file has the name.
  int restore_segment(int number, FileHandle& file);

  /// New segments' names are on the disk. Returns 0 or errno. Any thread.
  int sync() const;

 private:
  int open_directory();
  bool is_open_directory() const;

  std::string path_;
  mutable std::mutex mutex_;  ///< of directory_
  FileHandle directory_;      ///< locked
  JournalView found_;
  JournalPlace place_;
};

}  // namespace isthmus
