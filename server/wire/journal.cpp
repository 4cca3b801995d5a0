#include "server/wire/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "server/wire/log_frame.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

std::string segment_path(const std::string& directory, int segment) {
  char name[32];
  std::snprintf(name, sizeof name, "journal-%06d.lcm", segment);
  return (fs::path(directory) / name).string();
}

bool holds_a_log(const std::string& directory) {
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    if (entry.path().extension() == ".lcm") return true;
  }
  return false;
}

}  // namespace

Journal::Journal(std::string directory, const Message& first, JournalOptions options)
    : directory_(std::move(directory)), options_(std::move(options)) {
  std::error_code error;
  fs::create_directories(directory_, error);
  if (error) throw std::runtime_error(directory_ + ": " + error.message());
  if (holds_a_log(directory_)) {
    throw std::runtime_error(directory_ + ": holds a journal already; give a new directory");
  }
  append_log_frame(frame_, next_number_, first);
  if (const int failed = write_frame()) {
    throw std::runtime_error(segment_path(directory_, segment_) + ": " + errno_text(failed));
  }
  next_number_ += 1;
  syncer_ = std::jthread([this](const std::stop_token& stop) { sync_loop(stop); });
}

Journal::~Journal() {
  if (syncer_.joinable()) {
    syncer_.request_stop();
    syncer_.join();
  }
  if (file_.is_open()) ::fdatasync(file_.get());
}

bool Journal::append(const Message& message) {
  frame_.clear();
  append_log_frame(frame_, next_number_, message);
  const int error = write_frame();
  note_result(error);
  if (error) return false;
  next_number_ += 1;
  return true;
}

/// Writes frame_ whole, or leaves the segment as it was. Returns 0 or errno.
int Journal::write_frame() {
  const auto size = static_cast<std::int64_t>(frame_.size());
  const bool is_full = segment_size_ > 0 && segment_size_ + size > options_.segment_bytes;
  if (!file_.is_open() || is_full) {
    if (const int error = open_segment()) return error;
  }
  if (const int error = write_all(file_.get(), frame_)) {
    // Where even this fails, readers resynchronise behind the torn event.
    if (::ftruncate(file_.get(), segment_size_) != 0) segment_size_ = ::lseek(file_.get(), 0, SEEK_END);
    return error;
  }
  segment_size_ += size;
  total_bytes_ += size;
  unsynced_ = true;
  return 0;
}

int Journal::open_segment() {
  const std::string path = segment_path(directory_, segment_ + 1);
  FileHandle next(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666));
  if (!next.is_open()) return errno;
  if (file_.is_open()) ::fdatasync(file_.get());
  const std::lock_guard lock(file_mutex_);
  file_ = std::move(next);
  segment_ += 1;
  segment_size_ = 0;
  return 0;
}

void Journal::note_result(int error) {
  if (error) failures_ += 1;
  const bool was_failing = std::exchange(failing_, error != 0);
  if (was_failing == failing_ || !options_.report) return;
  options_.report(error ? "journal " + directory_ + ": " + errno_text(error) + "; events are lost to it"
                        : "journal " + directory_ + ": takes events again, after " +
                              std::to_string(failures_) + " lost so far");
}

void Journal::sync_loop(const std::stop_token& stop) {
  std::mutex mutex;
  std::unique_lock waiting(mutex);
  while (!stopped_.wait_for(waiting, stop, options_.sync_interval, [&] { return stop.stop_requested(); })) {
    if (!unsynced_.exchange(false)) continue;
    std::unique_lock lock(file_mutex_);
    const FileHandle file(::dup(file_.get()));
    lock.unlock();  // a slow disk must not hold up the appending thread
    if (::fdatasync(file.get()) != 0 && options_.report) {
      options_.report("journal " + directory_ + ": " + errno_text(errno) + " on writing to the disk");
    }
  }
}

}  // namespace isthmus
