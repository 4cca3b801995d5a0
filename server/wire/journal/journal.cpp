#include "server/wire/journal/journal.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "server/wire/journal/event_log.hpp"
#include "server/wire/journal/frames/journal_entry.hpp"
#include "server/wire/journal/frames/log_frame.hpp"
#include "server/wire/journal/journal_files.hpp"

namespace isthmus {
namespace {

/// Events that are written at once of those that waited: with each new one more go than come, and a disk that
/// comes back does not hold up the robots.
constexpr std::size_t events_at_once = 64;

/// What an event takes in memory while it waits.
std::int64_t held_bytes(const Message& message) {
  return static_cast<std::int64_t>(sizeof(Message) + message.channel.size() + message.bytes.size());
}

}  // namespace

Journal::Journal(std::string directory, JournalOptions options)
    : directory_(std::move(directory)),
      options_(std::move(options)),
      torn_bytes_(directory_.cut_torn_tail()),
      place_(directory_.place()) {
  if (const int error = open_segment())
    throw std::runtime_error(directory_.path() + ": " + errno_text(error));
  syncer_ = std::jthread([this](const std::stop_token& stop) { sync_loop(stop); });
}

Journal::~Journal() {
  if (syncer_.joinable()) {
    syncer_.request_stop();
    syncer_.join();
  }
  finish();
  // A segment without an event has no header, and is not missed.
  if (segment_size_ == 0 && !is_gone()) directory_.remove_segment(header_.segment);
}

SignatureCounters Journal::count_signatures() {
  SignatureCounters counters;
  const std::vector<JournalSegment>& segments = directory_.found().segments;
  // Backwards: what comes before a segment that begins with all counters need not be read.
  for (auto segment = segments.rbegin(); segment != segments.rend(); ++segment) {
    bool all_known = false;
    EventLogReader reader(segment->path);
    while (const std::optional<Message> message = reader.next()) {
      bool complete = false;
      if (raise_counters(*message, counters, complete) && complete) all_known = true;
    }
    if (all_known) break;
  }
  counters_ = counters;
  all_counters_due_ = true;
  return counters;
}

bool Journal::append(const Message& message) {
  write_waiting();
  if (waiting_.empty()) last_error_ = write(message);
  if (waiting_.empty() && last_error_ == 0) {
    note_state(State::taking);
    return true;
  }
  failures_ += 1;
  return keep_waiting(message);
}

bool Journal::keep_waiting(const Message& message) {
  const std::int64_t bytes = held_bytes(message);
  if (waiting_bytes_ + bytes > options_.waiting_bytes) {
    refused_ += 1;
    note_state(State::full);
    return false;
  }
  waiting_bytes_ += bytes;
  waiting_.push_back(message);
  if (state_ == State::taking) note_state(State::waiting);
  return true;
}

void Journal::write_waiting() {
  if (const int error = bring_back()) last_error_ = error;
  write_oldest(events_at_once);
}

std::size_t Journal::finish() {
  if (file_.is_open() && is_gone()) gone_ = true;
  if (const int error = bring_back()) last_error_ = error;
  write_oldest(std::numeric_limits<std::size_t>::max());
  sync();
  return waiting_.size();
}

void Journal::write_oldest(std::size_t max_count) {
  for (; max_count > 0 && !waiting_.empty(); --max_count) {
    if ((last_error_ = write(waiting_.front())) != 0) return;
    waiting_bytes_ -= held_bytes(waiting_.front());
    waiting_.pop_front();
  }
  if (waiting_.empty() && last_error_ == 0) note_state(State::taking);
}

std::string Journal::why_incomplete() const {
  if (gone_ && segment_size_ > 0)
    return segment_path(directory_.path(), header_.segment) +
           ": was deleted or replaced, and cannot be written again: " + errno_text(last_error_);
  try {
    const JournalView journal = view_journal(directory_.path());
    require_beginning(journal);
    const int last = journal.segments.empty() ? 0 : journal.segments.back().number;
    if (last < place_.segment) return segment_path(directory_.path(), last + 1) + ": is missing";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

/// Returns 0 or errno.
int Journal::write(const Message& message) {
  if (const int error = bring_back()) return error;
  std::int64_t next_number = put_together(message);
  const bool is_full =
      segment_size_ > 0 && segment_size_ + static_cast<std::int64_t>(frame_.size()) > options_.segment_bytes;
  if (is_full && rotate() == 0) next_number = put_together(message);
  if (const int error = write_frame()) return error;
  next_number_ = next_number;
  place_.journal = header_.journal;
  place_.segment = header_.segment;
  place_.header = header_.check;
  place_.next_sequence += 1;
  place_.received = std::max(place_.received, message.received);
  return 0;
}

/// The event with its entry in frame_, and between them what a restart must know of its signature: what a
/// crash leaves of them must not be a message that would be taken again. Returns the number of the next LCM
/// log event.
std::int64_t Journal::put_together(const Message& message) {
  std::int64_t number = next_number_;
  frame_.clear();
  event_.clear();
  if (segment_size_ == 0) {
    header_.utime = message.utime;
    append_segment_header(frame_, header_);
    number = 2;
  }
  const std::int64_t entry_number = number++;
  if (counters_ && message.signature) {
    const Signature& signature = *message.signature;
    (*counters_)[{signature.sender, signature.channel}] = signature.counter;
  }
  if (counters_ && all_counters_due_) {
    append_log_frame(event_, number++, encode_counters(message.utime, *counters_, true));
  } else if (counters_ && message.signature) {
    const Signature& signature = *message.signature;
    const SignatureCounters one = {{{signature.sender, signature.channel}, signature.counter}};
    append_log_frame(event_, number++, encode_counters(message.utime, one, false));
  }
  append_log_frame(event_, number++, message);
  append_entry(frame_, entry_number, message.utime, header_.secret, {place_.next_sequence, message.received},
               event_);
  return number;
}

/// Where no segment can be begun the present one grows on: better a long segment than a lost event. Returns 0
/// or errno.
int Journal::rotate() {
  // What has lost its name when it is closed is lost.
  gone_ = gone_ || is_gone();
  int error = bring_back();
  if (error == 0) error = open_segment();
  const bool could = std::exchange(rotates_, error == 0);
  if (could && error) report(errno_text(error) + " on beginning a new segment; the last one grows on");
  return error;
}

/// Writes frame_ whole, or leaves the segment as it was. Returns 0 or errno.
int Journal::write_frame() {
  if (torn_ && ::ftruncate(file_.get(), segment_size_) != 0) return errno;
  torn_ = false;
  if (const int error = options_.disk.write(file_.get(), frame_)) {
    torn_ = ::ftruncate(file_.get(), segment_size_) != 0;
    return error;
  }
  segment_size_ += static_cast<std::int64_t>(frame_.size());
  total_bytes_ += static_cast<std::int64_t>(frame_.size());
  written_ += 1;
  all_counters_due_ = false;
  return 0;
}

int Journal::open_segment() {
  FileHandle next;
  SegmentHeader header = header_after(place_);
  if (const int error = directory_.create_segment(header.segment, next)) return error;
  const std::lock_guard lock(file_mutex_);
  if (file_.is_open()) closed_.push_back(std::move(file_));
  file_ = std::move(next);
  header_ = header;
  next_number_ = 0;
  segment_size_ = 0;
  torn_ = false;
  segment_unsynced_ = true;
  all_counters_due_ = true;
  return 0;
}

/// Where the segment has lost its name it is written again, or, where another file has that name, the next
/// one is begun. Returns 0 or errno.
int Journal::bring_back() {
  if (!gone_.exchange(false) || !is_gone()) return 0;
  gone_ = true;
  const std::string path = segment_path(directory_.path(), header_.segment);
  std::unique_lock lock(file_mutex_);
  int error = directory_.restore_segment(header_.segment, file_);
  lock.unlock();
  const bool is_taken = error == EEXIST;
  if (is_taken && segment_size_ > 0) error = open_segment();
  if (error) return error;
  gone_ = false;
  segment_unsynced_ = true;
  failures_ += 1;
  report(is_taken
             ? path + " was replaced while it was written: its events are lost; the next segment is begun"
             : path + " was deleted while it was written, and is written again");
  if (const std::string lost = why_incomplete(); !lost.empty()) report("is not whole any more: " + lost);
  return 0;
}

bool Journal::is_gone() {
  const std::lock_guard lock(file_mutex_);
  return !directory_.names(header_.segment, file_);
}

void Journal::note_state(State state) {
  if (std::exchange(state_, state) == state) return;
  if (state == State::waiting) {
    report(errno_text(last_error_) + "; events wait in memory");
  } else if (state == State::full) {
    report(errno_text(last_error_) + "; " + std::to_string(waiting_.size()) +
           " events wait in memory, more are refused");
  } else {
    report("takes events again; " + std::to_string(refused_) +
           " were refused so far, all others are written");
  }
}

void Journal::report(const std::string& what) const {
  if (options_.report) options_.report("journal " + directory_.path() + ": " + what);
}

void Journal::sync_loop(const std::stop_token& stop) {
  std::mutex mutex;
  std::unique_lock waiting(mutex);
  while (!stopped_.wait_for(waiting, stop, options_.sync_interval, [&] { return stop.stop_requested(); })) {
    if (!gone_ && is_gone()) {
      gone_ = true;
      report("the segment that is written was deleted or replaced");
    }
    sync();
  }
}

/// What was written so far is on the disk, with the names of the segments that hold it.
void Journal::sync() {
  const std::lock_guard syncing(sync_mutex_);
  const std::int64_t written = written_;
  if (written == synced_ && !segment_unsynced_) return;
  std::unique_lock lock(file_mutex_);
  std::vector<FileHandle> closed = std::exchange(closed_, {});
  // A slow disk must not hold up the appending thread at its next segment; but it does rather than that
  // nothing is synced, where the process has no descriptor left.
  const FileHandle copy(::dup(file_.get()));
  if (copy.is_open()) lock.unlock();
  int error = 0;
  if (segment_unsynced_.exchange(false)) {
    error = directory_.sync();
    segment_unsynced_ = error != 0;
  }
  for (std::size_t i = 0; i < closed.size() && !error; ++i) error = options_.disk.sync(closed[i].get());
  if (!error) error = options_.disk.sync(copy.is_open() ? copy.get() : file_.get());
  if (!error) {
    synced_ = written;
    return;
  }
  report(errno_text(error) + " on writing to the disk; trying on");
  if (!lock.owns_lock()) lock.lock();
  std::move(closed.begin(), closed.end(), std::back_inserter(closed_));
}

}  // namespace isthmus
