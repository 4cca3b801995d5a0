#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>

#include "server/wire/journal/journal.hpp"

namespace isthmus {

/// A disk that refuses to write while it is told to; any thread may tell.
class FailingDisk {
 public:
  /// From now on each write ends with `error` after so many bytes; 0: all is written.
  void refuse_with(int error, std::size_t after_bytes = 0) {
    after_bytes_ = after_bytes;
    error_ = error;
  }

  /// Refers to this disk.
  JournalDisk operations() {
    JournalDisk disk;
    disk.write = [this](int descriptor, std::span<const std::uint8_t> bytes) {
      const int error = error_;
      if (error == 0) return write_all(descriptor, bytes);
      write_all(descriptor, bytes.first(std::min<std::size_t>(after_bytes_, bytes.size())));
      return error;
    };
    return disk;
  }

 private:
  std::atomic<int> error_ = 0;
  std::atomic<std::size_t> after_bytes_ = 0;
};

}  // namespace isthmus
