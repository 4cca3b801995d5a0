#include "server/engine/record/trajectory_store.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "server/engine/record/uninterrupted.hpp"

namespace isthmus {
namespace {

// Rows go to the file as they lie in memory: the file has no name and does not outlive the process.
static_assert(std::is_trivially_copyable_v<TrajectoryRow> && sizeof(TrajectoryRow) == 40);

constexpr std::size_t buffered_rows = 1024;

/// An open file without a name, in $TMPDIR or /tmp. Throws std::runtime_error naming the directory.
int open_unlinked_file() {
  const char* directory = std::getenv("TMPDIR");
  std::string path = (directory != nullptr && *directory != '\0' ? directory : "/tmp");
  path += "/isthmus-trajectory-XXXXXX";
  const int file = ::mkostemp(path.data(), O_CLOEXEC);
  if (file < 0) {
    throw std::runtime_error(path + ": cannot make a temporary file: " + std::strerror(errno));
  }
  ::unlink(path.c_str());
  return file;
}

bool write_at(int file, const char* bytes, std::size_t count, std::size_t offset) {
  while (count > 0) {
    const ssize_t written =
        uninterrupted([&] { return ::pwrite(file, bytes, count, static_cast<off_t>(offset)); });
    if (written <= 0) return false;
    bytes += written;
    offset += static_cast<std::size_t>(written);
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

/// The number of bytes read: fewer than `count` at the end of the file or on an error.
std::size_t read_at(int file, char* bytes, std::size_t count, std::size_t offset) {
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got = uninterrupted(
        [&] { return ::pread(file, bytes + done, count - done, static_cast<off_t>(offset + done)); });
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

}  // namespace

TrajectoryStore::TrajectoryStore() : file_(open_unlinked_file()) { buffer_.reserve(buffered_rows); }

TrajectoryStore::~TrajectoryStore() { ::close(file_); }

void TrajectoryStore::append(const TrajectoryRow& row) {
  buffer_.push_back(row);
  ++size_;
  // A full disk costs memory, not rows: the next multiple tries again.
  if (buffer_.size() % buffered_rows == 0) flush();
}

bool TrajectoryStore::flush() {
  if (buffer_.empty()) return true;
  const std::size_t flushed = flushed_.load(std::memory_order_relaxed);
  const auto* bytes = reinterpret_cast<const char*>(buffer_.data());
  if (!write_at(file_, bytes, buffer_.size() * sizeof(TrajectoryRow), flushed * sizeof(TrajectoryRow))) {
    return false;
  }
  flushed_.store(flushed + buffer_.size(), std::memory_order_release);
  buffer_.clear();
  return true;
}

std::vector<TrajectoryRow> TrajectoryStore::read(std::size_t first, std::size_t count) const {
  const std::size_t flushed = flushed_.load(std::memory_order_acquire);
  if (first >= flushed) return {};
  std::vector<TrajectoryRow> rows(std::min(count, flushed - first));
  const std::size_t bytes = read_at(file_, reinterpret_cast<char*>(rows.data()),
                                    rows.size() * sizeof(TrajectoryRow), first * sizeof(TrajectoryRow));
  rows.resize(bytes / sizeof(TrajectoryRow));
  const std::lock_guard lock(correcting_);
  for (auto it = corrections_.lower_bound(first); it != corrections_.end() && it->first < first + rows.size();
       ++it) {
    TrajectoryRow& row = rows[it->first - first];
    row.patch = it->second.patch;
    row.patch_from_robot = it->second.patch_from_robot;
  }
  return rows;
}

void TrajectoryStore::correct(const RowCorrection& correction) {
  const std::lock_guard lock(correcting_);
  corrections_.insert_or_assign(correction.row, correction);
}

std::vector<RowCorrection> TrajectoryStore::corrections() const {
  const std::lock_guard lock(correcting_);
  std::vector<RowCorrection> all;
  for (const auto& [row, correction] : corrections_) all.push_back(correction);
  return all;
}

}  // namespace isthmus
