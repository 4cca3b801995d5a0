#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "server/wire/file/file_bytes.hpp"
#include "server/wire/journal/journal_directory.hpp"
#include "server/wire/journal/signature.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

/// The disk as the journal uses it; each returns 0 or errno. Tests pass disks that are full or slow.
struct JournalDisk {
  std::function<int(int descriptor, std::span<const std::uint8_t> bytes)> write = write_all;
  std::function<int(int descriptor)> sync = sync_data;  ///< from any thread
};

struct JournalOptions {
  std::int64_t segment_bytes = 64 * 1024 * 1024;  ///< a segment that would grow beyond it is closed
  std::int64_t waiting_bytes = 64 * 1024 * 1024;  ///< so much of what the disk refuses waits in memory
  std::chrono::milliseconds sync_interval{1000};  ///< what was appended is on the disk after this time
  /// Called when the disk begins to refuse events, when no more can wait for it, and when it takes them
  /// again; from any thread.
  std::function<void(const std::string&)> report;
  JournalDisk disk;
};

/// The record of all events of the engine: an LCM log in segments journal-000001.lcm, ... of a directory,
/// each event handed to the kernel as it is appended, so that a crash of this process loses nothing. Before
/// each event stands an entry with its checks (lcmtypes/entry_t.lcm), and each segment begins with the
/// identity of the journal (lcmtypes/journal_t.lcm).
///
/// Events that the disk refuses wait in memory, in order, and are written first once the disk takes events
/// again, so a full disk that is given room loses no event unless the process ends before. A segment that is
/// deleted while it is written is written again from its file, which is still open.
class Journal {
 public:
  /// Begins a journal, or goes on with the one that the directory holds, in a new segment; a partly written
  /// event that a crash has left is truncated first. Throws as JournalDirectory.
  explicit Journal(std::string directory, JournalOptions options = {});
  ~Journal();

  /// The segments that were there before, in order; none for a new journal.
  const std::vector<JournalSegment>& earlier_segments() const { return directory_.found().segments; }
  std::int64_t torn_bytes() const { return torn_bytes_; }  ///< cut from the end of the last of them

  /// From now on, what is signed is preceded by its counter, and every segment begins with all counters.
  /// Returns those that the earlier segments hold.
  SignatureCounters count_signatures();

  /// True: the journal has the event, or will have it once the disk takes what waits. False: no more can
  /// wait, and the event must not be acted on. One thread may append, write what waits, and ask for the
  /// figures.
  bool append(const Message& message);

  /// Tries again to write a part of what waits: for times when nothing is appended.
  void write_waiting();
  /// The same with all of it, and what was written is on the disk; returns the number of events that the disk
  /// still refuses. Nothing may be appended any more.
  std::size_t finish();
  /// What of the journal is not in its directory any more, once it is finished; empty: nothing.
  std::string why_incomplete() const;

  std::int64_t bytes() const { return total_bytes_; }
  int segment() const { return header_.segment; }  ///< the one that is written; those before it are closed
  /// The number in the journal of the event that was appended last.
  std::int64_t last_sequence() const {
    return place_.next_sequence + static_cast<std::int64_t>(waiting_.size()) - 1;
  }
  std::int64_t last_received() const { return place_.received; }  ///< highest Message::received; -1: none
  std::size_t waiting() const { return waiting_.size(); }         ///< events
  std::int64_t appended() const { return written_ + static_cast<std::int64_t>(waiting_.size()); }  ///< events
  std::int64_t synced() const { return synced_; }  ///< of those appended, as many are on the disk
  /// Events that the disk did not take at once, and segments that were deleted.
  std::int64_t failures() const { return failures_; }

 private:
  enum class State { taking, waiting, full };

  bool keep_waiting(const Message& message);
  void write_oldest(std::size_t max_count);
  int write(const Message& message);
  int rotate();
  std::int64_t put_together(const Message& message);
  int write_frame();
  int open_segment();
  int bring_back();
  bool is_gone();
  void note_state(State state);
  void report(const std::string& what) const;
  void sync_loop(const std::stop_token& stop);
  void sync();

  JournalDirectory directory_;
  JournalOptions options_;
  std::int64_t torn_bytes_ = 0;
  JournalPlace place_;            ///< behind what is written
  SegmentHeader header_;          ///< of the segment that is written; on the disk once there is an event
  std::int64_t next_number_ = 0;  ///< of the segment's LCM log events
  std::int64_t segment_size_ = 0;
  bool torn_ = false;  ///< a part of a write could not be taken back
  std::int64_t total_bytes_ = 0;
  std::deque<Message> waiting_;
  std::int64_t waiting_bytes_ = 0;
  State state_ = State::taking;
  int last_error_ = 0;   ///< of the disk
  bool rotates_ = true;  ///< the last new segment could be begun
  std::int64_t failures_ = 0;
  std::int64_t refused_ = 0;                   ///< events that could not even wait
  std::vector<std::uint8_t> event_;            ///< of a write: what the entry covers
  std::vector<std::uint8_t> frame_;            ///< all of it
  std::optional<SignatureCounters> counters_;  ///< none: signatures are not counted
  bool all_counters_due_ = false;              ///< the segment lacks them yet

  std::mutex file_mutex_;  ///< file_ is replaced by the appending thread, read by the syncing one
  FileHandle file_;
  std::vector<FileHandle> closed_;         ///< segments before it that may not be on the disk yet; same mutex
  std::atomic<bool> gone_ = false;         ///< file_ has lost its name
  std::atomic<std::int64_t> written_ = 0;  ///< events
  std::atomic<std::int64_t> synced_ = 0;   ///< of them
  std::atomic<bool> segment_unsynced_ = false;  ///< a new segment's name is not known to be on the disk
  std::mutex sync_mutex_;                       ///< one at a time; before file_mutex_
  std::condition_variable_any stopped_;
  std::jthread syncer_;
};

}  // namespace isthmus
