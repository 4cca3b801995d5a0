#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace isthmus {

/// A file descriptor that closes itself.
class FileHandle {
 public:
  FileHandle() = default;
  explicit FileHandle(int descriptor) : descriptor_(descriptor) {}
  ~FileHandle() { close(); }
  FileHandle(FileHandle&& other) noexcept : descriptor_(other.descriptor_) { other.descriptor_ = -1; }
  FileHandle& operator=(FileHandle&& other) noexcept;

  int get() const { return descriptor_; }
  bool is_open() const { return descriptor_ >= 0; }
  void close();

 private:
  int descriptor_ = -1;
};

/// Reads a regular file through a window, so that memory does not grow with the file.
class FileBytes {
 public:
  /// Throws std::runtime_error naming the file and the reason.
  explicit FileBytes(std::string path);

  const std::string& path() const { return path_; }
  std::int64_t size() const { return size_; }

  /// `count` bytes from `offset`, fewer at the end; valid until the next call.
  std::span<const std::uint8_t> at(std::int64_t offset, std::int64_t count);

  /// The first place in [from, to) where the four bytes of `word` stand, big-endian; `to` where there is
  /// none.
  std::int64_t find_word(std::uint32_t word, std::int64_t from, std::int64_t to);

 private:
  void load(std::int64_t offset, std::int64_t count);

  std::string path_;
  FileHandle file_;
  std::int64_t size_ = 0;
  std::int64_t window_offset_ = 0;
  std::vector<std::uint8_t> window_;
};

/// Writes all bytes, through interruptions and short writes. Returns 0, or errno.
int write_all(int descriptor, std::span<const std::uint8_t> bytes);

/// What was written is on the disk. Returns 0, or errno.
int sync_data(int descriptor);

/// "Permission denied" of an errno, by a function that threads may share.
std::string errno_text(int number);

}  // namespace isthmus
