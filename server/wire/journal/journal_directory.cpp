#include "server/wire/journal/journal_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "server/engine/record/uninterrupted.hpp"
#include "server/wire/journal/frames/segment_reader.hpp"
#include "server/wire/journal/journal_files.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw std::runtime_error(path + ": " + errno_text(error));
}

bool is_file_at(const std::string& path, int descriptor) {
  struct stat named {};
  struct stat open {};
  return ::stat(path.c_str(), &named) == 0 && ::fstat(descriptor, &open) == 0 &&
         named.st_dev == open.st_dev && named.st_ino == open.st_ino;
}

/// Returns 0 or errno.
int copy_all(int from, int to) {
  std::array<std::uint8_t, 1 << 16> buffer{};
  for (off_t offset = 0;;) {
    const ssize_t got = uninterrupted([&] { return ::pread(from, buffer.data(), buffer.size(), offset); });
    if (got < 0) return errno;
    if (got == 0) return 0;
    if (const int error = write_all(to, std::span(buffer).first(static_cast<std::size_t>(got)))) return error;
    offset += got;
  }
}

}  // namespace

JournalDirectory::JournalDirectory(std::string path) : path_(std::move(path)) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) throw std::runtime_error(path_ + ": " + error.message());
  if (const int number = open_directory()) {
    if (number == EWOULDBLOCK) throw std::runtime_error(path_ + ": another server writes this journal");
    fail(path_, number);
  }
  found_ = view_journal(path_);
  require_beginning(found_);
  if (!found_.verified)
    throw std::runtime_error(path_ +
                             ": this journal was written before journals had checks; it can be replayed and "
                             "exported, but not gone on with: give another directory");
}

std::int64_t JournalDirectory::cut_torn_tail() {
  std::int64_t cut = 0;
  if (!found_.unbegun.empty()) {
    cut += FileBytes(found_.unbegun).size();
    if (::unlink(found_.unbegun.c_str()) != 0) fail(found_.unbegun, errno);
  }
  if (found_.segments.empty()) return cut;
  const std::string& segment = found_.segments.back().path;
  const SegmentEnd end = find_segment_end(segment);
  place_ = end.place;
  const FileHandle file(::open(segment.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.is_open()) fail(segment, errno);
  if (end.torn_bytes > 0 && ::ftruncate(file.get(), end.bytes) != 0) fail(segment, errno);
  // The process that wrote it may have left the last second of it to the kernel.
  if (::fdatasync(file.get()) != 0) fail(segment, errno);
  return cut + end.torn_bytes;
}

int JournalDirectory::create_segment(int number, FileHandle& file) const {
  const std::string path = segment_path(path_, number);
  file = FileHandle(::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666));
  return file.is_open() ? 0 : errno;
}

void JournalDirectory::remove_segment(int number) const { ::unlink(segment_path(path_, number).c_str()); }

bool JournalDirectory::names(int number, const FileHandle& file) const {
  return is_file_at(segment_path(path_, number), file.get());
}

int JournalDirectory::restore_segment(int number, FileHandle& file) {
  if (!is_open_directory()) {
    std::error_code error;
    fs::create_directories(path_, error);
    if (error) return error.value();
    if (const int number_of_error = open_directory()) return number_of_error;
  }
  FileHandle again;
  if (const int error = create_segment(number, again)) return error;
  if (const int error = copy_all(file.get(), again.get())) {
    remove_segment(number);
    return error;
  }
  file = std::move(again);
  return 0;
}

/// Returns 0 or errno; EWOULDBLOCK: another process holds it.
int JournalDirectory::open_directory() {
  FileHandle opened(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened.is_open() || ::flock(opened.get(), LOCK_EX | LOCK_NB) != 0) return errno;
  const std::lock_guard lock(mutex_);
  directory_ = std::move(opened);
  return 0;
}

bool JournalDirectory::is_open_directory() const {
  const std::lock_guard lock(mutex_);
  return is_file_at(path_, directory_.get());
}

int JournalDirectory::sync() const {
  std::unique_lock lock(mutex_);
  const FileHandle copy(::dup(directory_.get()));
  if (copy.is_open()) lock.unlock();  // else the process has no descriptor left
  return ::fsync(copy.is_open() ? copy.get() : directory_.get()) == 0 ? 0 : errno;
}

}  // namespace isthmus
