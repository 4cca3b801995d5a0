#include "server/wire/file/file_bytes.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "server/engine/record/uninterrupted.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t window_bytes = 1 << 20;

}  // namespace

FileHandle& FileHandle::operator=(FileHandle&& other) noexcept {
  if (this != &other) {
    close();
    descriptor_ = std::exchange(other.descriptor_, -1);
  }
  return *this;
}

void FileHandle::close() {
  if (is_open()) ::close(descriptor_);
  descriptor_ = -1;
}

// O_NONBLOCK: opening a FIFO would wait for a writer.
FileBytes::FileBytes(std::string path)
    : path_(std::move(path)), file_(::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  struct stat status {};
  if (!file_.is_open() || ::fstat(file_.get(), &status) != 0) {
    throw std::runtime_error(path_ + ": " + errno_text(errno));
  }
  if (!S_ISREG(status.st_mode)) throw std::runtime_error(path_ + ": not a regular file");
  size_ = status.st_size;
}

std::span<const std::uint8_t> FileBytes::at(std::int64_t offset, std::int64_t count) {
  if (offset >= size_) return {};
  count = std::min(count, size_ - offset);
  const std::int64_t window_end = window_offset_ + static_cast<std::int64_t>(window_.size());
  if (offset < window_offset_ || offset + count > window_end) load(offset, count);
  const std::int64_t loaded = window_offset_ + static_cast<std::int64_t>(window_.size()) - offset;
  return std::span(window_).subspan(static_cast<std::size_t>(offset - window_offset_),
                                    static_cast<std::size_t>(std::min(count, loaded)));
}

void FileBytes::load(std::int64_t offset, std::int64_t count) {
  window_offset_ = offset;
  window_.resize(static_cast<std::size_t>(std::min(std::max(count, window_bytes), size_ - offset)));
  std::size_t filled = 0;
  while (filled < window_.size()) {
    const ssize_t got = uninterrupted([&] {
      return ::pread(file_.get(), window_.data() + filled, window_.size() - filled,
                     offset + static_cast<std::int64_t>(filled));
    });
    if (got < 0) throw std::runtime_error(path_ + ": " + errno_text(errno));
    if (got == 0) break;  // the file became shorter while it was read
    filled += static_cast<std::size_t>(got);
  }
  window_.resize(filled);
}

std::int64_t FileBytes::find_word(std::uint32_t word, std::int64_t from, std::int64_t to) {
  const std::array<std::uint8_t, 4> pattern = {
      static_cast<std::uint8_t>(word >> 24), static_cast<std::uint8_t>(word >> 16),
      static_cast<std::uint8_t>(word >> 8), static_cast<std::uint8_t>(word)};
  const std::int64_t overlap = pattern.size() - 1;
  while (from < to) {
    const std::span<const std::uint8_t> chunk = at(from, std::min(to - from, window_bytes) + overlap);
    const auto hit = std::search(chunk.begin(), chunk.end(), pattern.begin(), pattern.end());
    if (hit != chunk.end()) return std::min(from + (hit - chunk.begin()), to);
    if (chunk.size() < pattern.size()) break;
    from += static_cast<std::int64_t>(chunk.size()) - overlap;
  }
  return to;
}

int write_all(int descriptor, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = uninterrupted([&] { return ::write(descriptor, bytes.data(), bytes.size()); });
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

int sync_data(int descriptor) { return ::fdatasync(descriptor) == 0 ? 0 : errno; }

std::string errno_text(int number) { return std::generic_category().message(number); }

}  // namespace isthmus
