#include "server/wire/journal_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "server/wire/event_log.hpp"
#include "server/wire/journal_files.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw std::runtime_error(path + ": " + errno_text(error));
}

}  // namespace

JournalDirectory::JournalDirectory(std::string path) : path_(std::move(path)) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) throw std::runtime_error(path_ + ": " + error.message());
  directory_ = FileHandle(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!directory_.is_open()) fail(path_, errno);
  if (::flock(directory_.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) throw std::runtime_error(path_ + ": another server writes this journal");
    fail(path_, errno);
  }
  list_segments();
}

void JournalDirectory::list_segments() {
  const JournalFiles files = list_journal(path_);
  for (const auto& [number, path] : files.segments) segments_.push_back(path);
  if (!files.segments.empty()) last_segment_ = files.segments.rbegin()->first;
  // Of segments that were pruned a snapshot may be all that is left.
  if (!files.snapshots.empty()) last_segment_ = std::max(last_segment_, files.snapshots.rbegin()->first);
}

std::int64_t JournalDirectory::cut_torn_tail() {
  if (segments_.empty()) return 0;
  const std::string& segment = segments_.back();
  const LogEnd end = find_log_end(segment);
  const FileHandle file(::open(segment.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.is_open()) fail(segment, errno);
  if (end.torn_bytes > 0 && ::ftruncate(file.get(), end.bytes) != 0) fail(segment, errno);
  // The process that wrote it may have left the last second of it to the kernel.
  if (::fdatasync(file.get()) != 0) fail(segment, errno);
  return end.torn_bytes;
}

int JournalDirectory::create_segment(int number, FileHandle& file) const {
  const std::string path = segment_path(path_, number);
  file = FileHandle(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666));
  return file.is_open() ? 0 : errno;
}

int JournalDirectory::sync() const { return ::fsync(directory_.get()) == 0 ? 0 : errno; }

}  // namespace isthmus
