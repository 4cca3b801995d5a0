#include "server/wire/journal.hpp"

#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <utility>

#include "server/wire/event_log.hpp"
#include "server/wire/log_frame.hpp"

namespace isthmus {
namespace {

/// What is written with a message's bytes: headers, channels and a counter.
constexpr std::int64_t frame_overhead_bytes = 256;

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
  if (file_.is_open()) ::fdatasync(file_.get());
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
  const std::int64_t number = next_number_;
  int error = rotate_if_full(static_cast<std::int64_t>(message.bytes.size()));
  if (!error) {
    put_together(message);
    error = write_frame();
  }
  if (error) next_number_ = number;
  note_result(error);
  return error == 0;
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

int Journal::rotate_if_full(std::int64_t message_bytes) {
  const bool is_full =
      segment_size_ > 0 && segment_size_ + message_bytes + frame_overhead_bytes > options_.segment_bytes;
  return is_full ? open_segment() : 0;
}

/// Writes frame_ whole, or leaves the segment as it was. Returns 0 or errno.
int Journal::write_frame() {
  const auto size = static_cast<std::int64_t>(frame_.size());
  if (const int error = write_all(file_.get(), frame_)) {
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
  if (file_.is_open()) ::fdatasync(file_.get());
  const std::lock_guard lock(file_mutex_);
  file_ = std::move(next);
  segment_ += 1;
  segment_size_ = 0;
  segment_unsynced_ = true;
  all_counters_due_ = true;
  return 0;
}

void Journal::note_result(int error) {
  if (error) failures_ += 1;
  const bool was_failing = std::exchange(failing_, error != 0);
  if (was_failing == failing_ || !options_.report) return;
  options_.report(error
                      ? "journal " + directory_.path() + ": " + errno_text(error) + "; events are lost to it"
                      : "journal " + directory_.path() + ": takes events again, after " +
                            std::to_string(failures_) + " lost so far");
}

void Journal::sync_loop(const std::stop_token& stop) {
  std::mutex mutex;
  std::unique_lock waiting(mutex);
  while (!stopped_.wait_for(waiting, stop, options_.sync_interval, [&] { return stop.stop_requested(); })) {
    // A segment that the directory does not name is lost with all that is in it.
    if (segment_unsynced_.exchange(false)) directory_.sync();
    if (!unsynced_.exchange(false)) continue;
    std::unique_lock lock(file_mutex_);
    const FileHandle file(::dup(file_.get()));
    lock.unlock();  // a slow disk must not hold up the appending thread
    if (::fdatasync(file.get()) != 0 && options_.report) {
      options_.report("journal " + directory_.path() + ": " + errno_text(errno) + " on writing to the disk");
    }
  }
}

}  // namespace isthmus
