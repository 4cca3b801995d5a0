#include "server/wire/journal.hpp"

#include <unistd.h>

#include <limits>
#include <stdexcept>
#include <utility>

#include "server/wire/event_log.hpp"
#include "server/wire/log_frame.hpp"

namespace isthmus {
namespace {

/// What is written with a message's bytes: headers, channels and a counter.
constexpr std::int64_t frame_overhead_bytes = 256;
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
      segment_(directory_.last_segment()) {
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
  sync_closed();
  if (file_.is_open()) options_.disk.sync(file_.get());
  directory_.sync();
}

SignatureCounters Journal::count_signatures() {
  SignatureCounters counters;
  const std::vector<std::string>& segments = directory_.segments();
  // Backwards: what comes before a segment that begins with all counters need not be read.
  for (auto segment = segments.rbegin(); segment != segments.rend(); ++segment) {
    bool all_known = false;
    EventLogReader reader(*segment);
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

void Journal::write_waiting() { write_oldest(events_at_once); }

std::size_t Journal::finish() {
  write_oldest(std::numeric_limits<std::size_t>::max());
  return waiting_.size();
}

void Journal::write_oldest(std::size_t most) {
  for (; most > 0 && !waiting_.empty(); --most) {
    if ((last_error_ = write(waiting_.front())) != 0) return;
    waiting_bytes_ -= held_bytes(waiting_.front());
    waiting_.pop_front();
  }
  if (waiting_.empty() && last_error_ == 0) note_state(State::taking);
}

/// Returns 0 or errno.
int Journal::write(const Message& message) {
  const std::int64_t number = next_number_;
  rotate_if_full(static_cast<std::int64_t>(message.bytes.size()));
  put_together(message);
  const int error = write_frame();
  if (error) next_number_ = number;
  return error;
}

/// The event in frame_, and before it what a restart must know of its signature: what a crash leaves of them
/// must not be a message that would be taken again.
void Journal::put_together(const Message& message) {
  frame_.clear();
  if (counters_ && message.signature) {
    const Signature& signature = *message.signature;
    (*counters_)[{signature.sender, signature.channel}] = signature.counter;
  }
  if (counters_ && all_counters_due_) {
    put(encode_counters(message.utime, *counters_, true));
  } else if (counters_ && message.signature) {
    const Signature& signature = *message.signature;
    const SignatureCounters one = {{{signature.sender, signature.channel}, signature.counter}};
    put(encode_counters(message.utime, one, false));
  }
  put(message);
}

void Journal::put(const Message& message) { append_log_frame(frame_, next_number_++, message); }

/// Where no segment can be begun the present one grows on: better a long segment than a lost event.
void Journal::rotate_if_full(std::int64_t message_bytes) {
  const bool is_full =
      segment_size_ > 0 && segment_size_ + message_bytes + frame_overhead_bytes > options_.segment_bytes;
  if (!is_full) return;
  const int error = open_segment();
  const bool could = std::exchange(rotates_, error == 0);
  if (could && error) report(errno_text(error) + " on beginning a new segment; the last one grows on");
}

/// Writes frame_ whole, or leaves the segment as it was. Returns 0 or errno.
int Journal::write_frame() {
  const auto size = static_cast<std::int64_t>(frame_.size());
  if (const int error = options_.disk.write(file_.get(), frame_)) {
    // Where even this fails, readers resynchronise behind the torn event.
    if (::ftruncate(file_.get(), segment_size_) != 0) segment_size_ = ::lseek(file_.get(), 0, SEEK_END);
    return error;
  }
  segment_size_ += size;
  total_bytes_ += size;
  unsynced_ = true;
  all_counters_due_ = false;
  return 0;
}

int Journal::open_segment() {
  FileHandle next;
  if (const int error = directory_.create_segment(segment_ + 1, next)) return error;
  const std::lock_guard lock(file_mutex_);
  if (file_.is_open()) closed_.push_back(std::move(file_));
  file_ = std::move(next);
  segment_ += 1;
  segment_size_ = 0;
  segment_unsynced_ = true;
  all_counters_due_ = true;
  return 0;
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
    // A segment that the directory does not name is lost with all that is in it.
    if (segment_unsynced_.exchange(false)) directory_.sync();
    if (!unsynced_.exchange(false)) continue;
    sync_closed();
    std::unique_lock lock(file_mutex_);
    const FileHandle file(::dup(file_.get()));
    lock.unlock();  // a slow disk must not hold up the appending thread
    if (const int error = options_.disk.sync(file.get()))
      report(errno_text(error) + " on writing to the disk");
  }
}

void Journal::sync_closed() {
  std::unique_lock lock(file_mutex_);
  const std::vector<FileHandle> closed = std::exchange(closed_, {});
  lock.unlock();
  for (const FileHandle& file : closed) {
    if (const int error = options_.disk.sync(file.get()))
      report(errno_text(error) + " on writing to the disk");
  }
}

}  // namespace isthmus
