#include "server/wire/journal/recovery/snapshots.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>

#include "server/engine/record/uninterrupted.hpp"
#include "server/wire/file/file_bytes.hpp"
#include "server/wire/journal/frames/spool_file.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/journal/journal_view.hpp"
#include "server/wire/journal/recovery/recovery.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kept_snapshots = 2;  // should the newest not be readable

/// Held while snapshots are made. Not open: another process holds it, and was not waited for.
FileHandle lock(const std::string& directory, bool wait) {
  const std::string path = (fs::path(directory) / "snapshots.lock").string();
  FileHandle file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  if (!file.is_open()) throw std::runtime_error(path + ": " + errno_text(errno));
  const int how = wait ? LOCK_EX : LOCK_EX | LOCK_NB;
  if (uninterrupted([&] { return ::flock(file.get(), how); }) != 0) file.close();
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

/// Of the segment that is written, whether it has a header yet or not.
int last_number(const JournalView& journal) {
  const int last = journal.segments.empty() ? 0 : journal.segments.back().number;
  return journal.unbegun.empty() ? last : last + 1;
}

void write_next(const std::string& directory, int segment, const SnapshotPolicy& policy) {
  RecoveryOptions options;
  options.last_segment = segment;
  options.warn = policy.warn;
  Recovery recovery(directory, options);
  ServedMap map = recovery.begin();
  while (recovery.step(map)) {
  }
  sync(segment_path(directory, segment));  // a snapshot must not know what a power cut takes from the journal
  write_snapshot(directory, recovery.place(), map, recovery.trajectory());
}

/// The rows' files stay: newer snapshots need those of the older ones. So do snapshots of other journals.
void remove_old_snapshots(std::map<int, std::string>& snapshots) {
  while (snapshots.size() > kept_snapshots) {
    fs::remove(snapshots.begin()->second);
    snapshots.erase(snapshots.begin());
  }
}

int prune_segments(const JournalView& journal, const std::map<int, std::string>& snapshots, int keep) {
  if (snapshots.size() < kept_snapshots) return 0;
  const int held = snapshots.begin()->first;
  int first_kept = last_number(journal) - keep;
  // They tell which messages of the spool were handled.
  if (const auto first = first_segment_of_spool(journal.directory)) first_kept = std::min(first_kept, *first);
  int pruned = 0;
  for (const JournalSegment& segment : journal.segments) {
    if (segment.number > held || segment.number >= first_kept) break;
    fs::remove(segment.path);
    ++pruned;
  }
  return pruned;
}

}  // namespace

SnapshotsMade update_snapshots(const std::string& directory, const SnapshotPolicy& policy) {
  SnapshotsMade made;
  const FileHandle held = lock(directory, policy.wait);
  made.busy = !held.is_open();
  if (made.busy) return made;
  remove_unfinished(directory);
  const JournalView journal = view_journal(directory);
  if (!journal.verified)
    throw std::runtime_error(directory +
                             ": was written before journals had checks: no snapshots are made of it");
  std::map<int, std::string> snapshots = own_snapshots(journal, policy.warn);
  if (!snapshots.empty()) made.last_segment = snapshots.rbegin()->first;
  for (const JournalSegment& segment : journal.segments) {
    if (segment.number == last_number(journal) || segment.number <= made.last_segment) continue;
    write_next(directory, segment.number, policy);
    snapshots.emplace(segment.number, snapshot_path(directory, segment.number));
    made.last_segment = segment.number;
    ++made.written;
    remove_old_snapshots(snapshots);
  }
  if (policy.keep_segments) made.pruned_segments = prune_segments(journal, snapshots, *policy.keep_segments);
  return made;
}

}  // namespace isthmus
