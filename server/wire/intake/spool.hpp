#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "server/wire/file/file_bytes.hpp"
#include "server/wire/intake/receipts.hpp"
#include "server/wire/journal/journal.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

struct SpoolOptions {
  std::int64_t file_bytes = 4 * 1024 * 1024;  ///< a file that would grow beyond it is closed
  /// What may wait to be handled, in bytes: more than the inbox holds, as handled messages stay until the
  /// journal is on the disk.
  std::int64_t max_bytes = 2 * std::int64_t{512} * 1024 * 1024;
  std::chrono::milliseconds sync_interval{250};  ///< what was received is on the disk after this time
  JournalDisk disk;
  int journal_segment = 1;       ///< the one that is written
  std::int64_t next_number = 0;  ///< at least
  /// Called when the disk begins to refuse messages and when it takes them again; any thread.
  std::function<void(const std::string&)> report;
  /// Called whenever more messages are on the disk; from a thread of the spool's own.
  std::function<void(const Receipts&)> acknowledge;
};

/// The messages that were received and are not handled yet, in files beside the journal: each is handed to
/// the kernel before it waits in memory, and stays until the journal has it on the disk, so that neither a
/// crash nor a power cut loses what was acknowledged.
///
/// A file whose messages are all settled is deleted. Where few of many are not, they are moved on to the
/// newest file: files take twice what waits, and some files of `file_bytes` more.
class Spool {
 public:
  /// Continues with what the directory holds. `settled`: numbers of messages that the journal has, or has
  /// counted as dropped, in its segments from `first_segment_of_spool` on. The directory must be held by this
  /// process (JournalDirectory). Throws std::runtime_error naming file and reason where it cannot be read or
  /// written.
  Spool(std::string directory, const std::set<std::int64_t>& settled, SpoolOptions options = {});
  ~Spool();

  /// The messages that were found and not settled, in the order in which they came; once.
  std::vector<Message> take_found() { return std::move(found_); }
  /// Partly written or damaged bytes that were found.
  std::int64_t lost_bytes() const { return lost_bytes_; }
  /// How far senders had counted in what was found, settled or not.
  const SignatureCounters& counters() const { return counters_; }

  /// Gives the message its number; leaves it without where the disk refuses it. `known`: see Receipts.
  void append(Message& message, bool known);

  /// The message was handled, and its trace is on the disk; or another file of the spool has it. −1: none.
  void settle(std::int64_t number);

  /// The journal writes this segment from now on. Any thread.
  void set_journal_segment(int segment) { journal_segment_ = segment; }

  /// All that is not settled is on the disk; where all is, only an empty file stays.
  void finish();

  std::int64_t waiting() const;                      ///< messages that are not settled
  std::int64_t bytes() const;                        ///< of all files
  std::int64_t refused() const { return refused_; }  ///< messages that the disk did not take

 private:
  struct File {
    std::string path;
    std::int64_t bytes = 0;
    std::int64_t waiting = 0;        ///< messages that are not settled
    std::int64_t waiting_bytes = 0;  ///< theirs
    bool stays = false;              ///< what was moved on from it may not be on the disk yet
    bool readable = true;
  };
  struct Place {
    std::int64_t file = 0;  ///< its first number
    std::int64_t bytes = 0;
  };
  struct SpooledBytes {
    std::int64_t number = 0;
    std::vector<std::uint8_t> bytes;
  };

  void find(const std::set<std::int64_t>& settled);
  void find_in(std::int64_t first, const std::string& path, const std::set<std::int64_t>& settled);
  int begin_file();
  int write(std::span<const std::uint8_t> bytes);
  int write_to_file(std::span<const std::uint8_t> bytes);
  void place(std::int64_t number, std::int64_t bytes);
  void unplace(std::map<std::int64_t, Place>::iterator found);
  void remove_if_settled(std::int64_t file);
  std::optional<std::int64_t> wasteful_file() const;
  std::vector<SpooledBytes> waiting_in(std::int64_t file) const;
  void move_on(std::int64_t file);
  void move(const SpooledBytes& message);
  void note(int error);
  void sync_loop(const std::stop_token& stop);
  int sync();
  void report(const std::string& what) const;

  std::string directory_;
  FileHandle directory_handle_;
  SpoolOptions options_;
  std::vector<Message> found_;
  std::int64_t lost_bytes_ = 0;
  SignatureCounters counters_;
  std::atomic<int> journal_segment_;
  std::atomic<std::int64_t> refused_ = 0;

  std::mutex append_mutex_;  ///< held while a message is written; the first of the three
  std::int64_t next_number_ = 0;
  std::vector<std::uint8_t> frame_;
  FileHandle file_;
  bool broken_ =
      false;       ///< there is no file, or it ends with a part of a message that could not be taken back
  int error_ = 0;  ///< of the disk, at the last message

  mutable std::mutex mutex_;            ///< the last of the three
  std::int64_t current_ = -1;           ///< the file that is written; −1: none
  std::map<std::int64_t, File> files_;  ///< by their first numbers
  std::map<std::int64_t, Place> places_;
  std::int64_t bytes_ = 0;
  std::int64_t waiting_bytes_ = 0;
  Receipts receipts_;
  std::vector<FileHandle> closed_;  ///< files that may not be on the disk yet
  bool unsynced_ = false;           ///< messages, or the name of a file, are not known to be on the disk

  std::mutex sync_mutex_;  ///< one at a time
  int sync_error_ = 0;     ///< of the last time
  std::condition_variable_any stopped_;
  std::jthread syncer_;
};

}  // namespace isthmus
