#include "server/wire/journal_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "server/wire/event_log.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

std::string segment_name(int segment) {
  char name[32];
  std::snprintf(name, sizeof name, "journal-%06d.lcm", segment);
  return name;
}

/// 0 where the name is not a segment's.
int segment_number(const std::string& name) {
  int number = 0;
  if (std::sscanf(name.c_str(), "journal-%d.lcm", &number) != 1) return 0;
  return number > 0 && segment_name(number) == name ? number : 0;
}

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
  for (const fs::directory_entry& entry : fs::directory_iterator(path_)) {
    if (entry.path().extension() != ".lcm") continue;
    const int number = segment_number(entry.path().filename().string());
    if (number == 0) {
      throw std::runtime_error(path_ + ": holds " + entry.path().filename().string() +
                               ", which is no segment of a journal; give another directory");
    }
    segments_.push_back(entry.path().string());
    last_segment_ = std::max(last_segment_, number);
  }
  std::sort(segments_.begin(), segments_.end());
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
  const std::string path = (fs::path(path_) / segment_name(number)).string();
  file = FileHandle(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666));
  return file.is_open() ? 0 : errno;
}

int JournalDirectory::sync() const { return ::fsync(directory_.get()) == 0 ? 0 : errno; }

}  // namespace isthmus
