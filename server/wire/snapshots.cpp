#include "server/wire/snapshots.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>

#include "server/wire/file_bytes.hpp"
#include "server/wire/journal_files.hpp"
#include "server/wire/recovery.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kept_snapshots = 2;  // should the newest not be readable

/// Held while snapshots are made. Not open: another process holds it.
FileHandle lock(const std::string& directory) {
  const std::string path = (fs::path(directory) / "snapshots.lock").string();
  FileHandle file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  if (!file.is_open()) throw std::runtime_error(path + ": " + errno_text(errno));
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) file.close();
  return file;
}

/// What a process that was stopped while it wrote has left.
void remove_unfinished(const std::string& directory) {
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    const bool ours = name.starts_with("snapshot-") || name.starts_with("trajectory-");
    if (ours && name.find(".isthmus.tmp-") != std::string::npos) fs::remove(entry.path());
  }
}

void sync(const std::string& path) {
  const FileHandle file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open() || ::fsync(file.get()) != 0) throw std::runtime_error(path + ": " + errno_text(errno));
}

void write_next(const std::string& directory, int segment, const SnapshotPolicy& policy) {
  Recovery recovery(directory, {segment, policy.warn});
  ServedMap map = recovery.begin();
  while (recovery.step(map)) {
  }
  sync(segment_path(directory, segment));  // a snapshot must not know what a power cut takes from the journal
  write_snapshot(directory, segment, map, recovery.trajectory());
}

/// The rows' files stay: newer snapshots need those of the older ones.
void remove_old_snapshots(const std::string& directory) {
  auto snapshots = list_journal(directory).snapshots;
  while (snapshots.size() > kept_snapshots) {
    fs::remove(snapshots.begin()->second);
    snapshots.erase(snapshots.begin());
  }
}

int prune_segments(const std::string& directory, int keep) {
  const JournalFiles files = list_journal(directory);
  if (files.snapshots.size() < kept_snapshots) return 0;
  const int held = files.snapshots.begin()->first;
  const int first_kept = files.segments.rbegin()->first - keep;
  int pruned = 0;
  for (const auto& [segment, path] : files.segments) {
    if (segment > held || segment >= first_kept) break;
    fs::remove(path);
    ++pruned;
  }
  return pruned;
}

}  // namespace

SnapshotsMade update_snapshots(const std::string& directory, const SnapshotPolicy& policy) {
  SnapshotsMade made;
  const FileHandle held = lock(directory);
  if (!held.is_open()) return made;
  remove_unfinished(directory);
  const JournalFiles files = list_journal(directory);
  if (!files.snapshots.empty()) made.last_segment = files.snapshots.rbegin()->first;
  for (const auto& [segment, path] : files.segments) {
    const bool closed = segment != files.segments.rbegin()->first;
    if (!closed || segment <= made.last_segment) continue;
    write_next(directory, segment, policy);
    made.last_segment = segment;
    ++made.written;
    remove_old_snapshots(directory);
  }
  if (policy.keep_segments) made.pruned_segments = prune_segments(directory, *policy.keep_segments);
  return made;
}

}  // namespace isthmus
