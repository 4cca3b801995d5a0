#include "server/wire/journal/recovery/snapshots.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <iterator>
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

/// Held while snapshots are made, and gone afterwards, however that ends. What a process that was killed
/// leaves locks nobody out.
class MakersLock {
 public:
  /// Not taken: another process holds it, and was not waited for.
  MakersLock(const std::string& directory, bool wait)
      : path_((fs::path(directory) / "snapshots.lock").string()) {
    const int how = wait ? LOCK_EX : LOCK_EX | LOCK_NB;
    do {
      file_ = FileHandle(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
      if (!file_.is_open()) throw std::runtime_error(path_ + ": " + errno_text(errno));
      if (uninterrupted([&] { return ::flock(file_.get(), how); }) == 0) continue;
      const int error = errno;
      file_.close();
      if (error != EWOULDBLOCK) throw std::runtime_error(path_ + ": " + errno_text(error));
      return;
    } while (!is_named());  // the one before has taken it away with it
  }
  ~MakersLock() {
    if (is_taken()) ::unlink(path_.c_str());
  }
  MakersLock(const MakersLock&) = delete;
  MakersLock& operator=(const MakersLock&) = delete;

  bool is_taken() const { return file_.is_open(); }

 private:
  bool is_named() const {
    struct stat named {};
    struct stat open {};
    return ::stat(path_.c_str(), &named) == 0 && ::fstat(file_.get(), &open) == 0 &&
           named.st_dev == open.st_dev && named.st_ino == open.st_ino;
  }

  std::string path_;
  FileHandle file_;
};

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
void remove_old_snapshots(std::map<int, std::string>& snapshots, int keep) {
  std::vector<int> segments;
  for (const auto& [segment, path] : snapshots) segments.push_back(segment);
  while (const std::optional<int> segment = dispensable_snapshot(segments, keep)) {
    fs::remove(snapshots.at(*segment));
    snapshots.erase(*segment);
    std::erase(segments, *segment);
  }
}

int prune_segments(const JournalView& journal, const std::map<int, std::string>& snapshots, int keep) {
  if (snapshots.size() < std::size_t{least_kept_snapshots}) return 0;
  const int held = std::prev(snapshots.end(), least_kept_snapshots)->first;
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

std::optional<int> dispensable_snapshot(const std::vector<int>& segments, int keep) {
  const std::size_t count = segments.size();
  if (count <= static_cast<std::size_t>(std::max(keep, least_kept_snapshots))) return std::nullopt;
  // Without one, there is a gap; the longer ago it was, the wider it may be. By the root: in proportion, ten
  // snapshots would leave most of a long journal without any.
  const auto gap = [&](std::size_t i) {
    return (segments[i + 1] - segments[i - 1]) / std::sqrt(segments.back() - segments[i]);
  };
  std::size_t least = 0;
  for (std::size_t i = 1; i + least_kept_snapshots < count; ++i)
    if (least == 0 || gap(i) < gap(least)) least = i;
  return segments[least];
}

SnapshotsMade update_snapshots(const std::string& directory, const SnapshotPolicy& policy) {
  SnapshotsMade made;
  if (list_journal(directory).segments.empty())
    throw std::runtime_error(directory + ": holds no segment of a journal");
  const MakersLock lock(directory, policy.wait);
  made.busy = !lock.is_taken();
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
    remove_old_snapshots(snapshots, policy.keep_snapshots);
  }
  remove_old_snapshots(snapshots, policy.keep_snapshots);
  if (policy.keep_segments) made.pruned_segments = prune_segments(journal, snapshots, *policy.keep_segments);
  return made;
}

}  // namespace isthmus
