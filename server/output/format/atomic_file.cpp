#include "server/output/format/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "server/engine/record/uninterrupted.hpp"

namespace isthmus {
namespace {

constexpr std::size_t buffer_bytes = 1 << 16;

/// A rename lasts through a power cut only when its directory is on disk too. Not every file system can.
void sync_directory_of(const std::string& path) {
  std::string directory = std::filesystem::path(path).parent_path().string();
  if (directory.empty()) directory = ".";
  const int file = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace

AtomicFile::AtomicFile(std::string path)
    : path_(std::move(path)), temporary_path_(path_ + ".tmp-" + std::to_string(::getpid())) {
  file_ = ::open(temporary_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0) fail("cannot be written");
}

AtomicFile::~AtomicFile() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(temporary_path_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  buffer_.append(bytes);
  if (buffer_.size() >= buffer_bytes) write_buffer();
}

void AtomicFile::commit() {
  write_buffer();
  if (::fsync(file_) != 0) fail("cannot be synced to disk");
  if (::rename(temporary_path_.c_str(), path_.c_str()) != 0) fail("cannot be put in place");
  ::close(file_);
  file_ = -1;
  sync_directory_of(path_);
}

void AtomicFile::write_buffer() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = uninterrupted([&] { return ::write(file_, rest.data(), rest.size()); });
    if (written < 0) fail("cannot be written");
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  buffer_.clear();
}

void AtomicFile::fail(const char* action) const {
  throw std::runtime_error(path_ + ": " + action + ": " + std::strerror(errno));
}

void make_directory(const std::string& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw std::runtime_error(directory + ": cannot be made: " + error.message());
}

}  // namespace isthmus
