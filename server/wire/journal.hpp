#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/wire/file_bytes.hpp"
#include "server/wire/journal_directory.hpp"
#include "server/wire/message.hpp"
#include "server/wire/signature.hpp"

namespace isthmus {

struct JournalOptions {
  std::int64_t segment_bytes = 64 * 1024 * 1024;  ///< a segment that would grow beyond it is closed
  std::chrono::milliseconds sync_interval{1000};  ///< what was appended is on the disk after this time
  /// Told when the disk begins to refuse events, and when it takes them again; from any thread.
  std::function<void(const std::string&)> report;
};

/// The record of what the engine was told: an LCM log in segments journal-000001.lcm, ... of a directory,
/// each event handed to the kernel as it is appended, so that a crash of this process loses nothing.
class Journal {
 public:
  /// Begins a journal, or goes on with the one that the directory holds, in a new segment; the torn tail that
  /// a crash may have left is cut before. Throws std::runtime_error naming the directory or file and the
  /// reason.
  explicit Journal(std::string directory, JournalOptions options = {});
  ~Journal();

  /// The segments that were there before, in order; none for a new journal.
  const std::vector<std::string>& earlier_segments() const { return directory_.segments(); }
  std::int64_t torn_bytes() const { return torn_bytes_; }  ///< cut from the end of the last of them

  /// From now on, what is signed is preceded by its counter, and every segment begins with all counters.
  /// Returns those that the earlier segments hold.
  SignatureCounters count_signatures();

  /// One thread may append. False where the disk refused the event: it is counted and not in the journal; the
  /// next is tried again.
  bool append(const Message& message);

  std::int64_t bytes() const { return total_bytes_; }
  int segment() const { return segment_; }  ///< the one that is written; those before it are closed
  std::int64_t failures() const { return failures_; }  ///< events refused; any thread may ask

 private:
  int rotate_if_full(std::int64_t message_bytes);
  void put_together(const Message& message);
  int write_frame();
  void put(const Message& message);
  int open_segment();
  void note_result(int error);
  void sync_loop(const std::stop_token& stop);

  JournalDirectory directory_;
  JournalOptions options_;
  std::int64_t torn_bytes_ = 0;
  int segment_ = 0;
  std::int64_t next_number_ = 0;
  std::int64_t segment_size_ = 0;
  std::int64_t total_bytes_ = 0;
  bool failing_ = false;
  std::atomic<std::int64_t> failures_ = 0;
  std::vector<std::uint8_t> frame_;
  std::optional<SignatureCounters> counters_;  ///< none: signatures are not counted
  bool all_counters_due_ = false;              ///< the segment lacks them yet

  std::mutex file_mutex_;  ///< file_ is replaced by the appending thread, read by the syncing one
  FileHandle file_;
  std::atomic<bool> unsynced_ = false;
  std::atomic<bool> segment_unsynced_ = false;  ///< a new segment's name is not known to be on the disk
  std::condition_variable_any stopped_;
  std::jthread syncer_;
};

}  // namespace isthmus
