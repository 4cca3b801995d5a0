#include "server/wire/intake/spool.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "server/wire/journal/frames/spool_file.hpp"

namespace isthmus {

Spool::Spool(std::string directory, const std::set<std::int64_t>& settled, SpoolOptions options)
    : directory_(std::move(directory)),
      options_(std::move(options)),
      journal_segment_(options_.journal_segment) {
  next_number_ = options_.next_number;
  if (!settled.empty()) next_number_ = std::max(next_number_, *settled.rbegin() + 1);
  directory_handle_ = FileHandle(::open(directory_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!directory_handle_.is_open()) throw std::runtime_error(directory_ + ": " + errno_text(errno));
  find(settled);
  const int error = begin_file();
  broken_ = error != 0;
  note(error);
  if (!error) {
    for (const auto& [first, path] : list_spool(directory_)) remove_if_settled(first);
  }
  syncer_ = std::jthread([this](const std::stop_token& stop) { sync_loop(stop); });
}

Spool::~Spool() {
  syncer_.request_stop();
  syncer_.join();
  sync();
}

void Spool::find(const std::set<std::int64_t>& settled) {
  for (const auto& [first, path] : list_spool(directory_)) find_in(first, path, settled);
  std::sort(found_.begin(), found_.end(),
            [](const Message& a, const Message& b) { return a.received < b.received; });
}

void Spool::find_in(std::int64_t first, const std::string& path, const std::set<std::int64_t>& settled) {
  files_[first].path = path;
  current_ = first;
  next_number_ = std::max(next_number_, first);
  const SpoolFileEnd end = read_spool_file(path, [&](Message&& message, auto bytes) {
    next_number_ = std::max({next_number_, first + 1, message.received + 1});
    if (const auto& signature = message.signature) {
      std::int64_t& counter = counters_.try_emplace({signature->sender, signature->channel}).first->second;
      counter = std::max(counter, signature->counter);
    }
    const bool is_copy = places_.contains(message.received);  // it was being moved on
    if (is_copy || settled.contains(message.received)) return;
    place(message.received, static_cast<std::int64_t>(bytes.size()));
    found_.push_back(std::move(message));
  });
  lost_bytes_ += end.lost_bytes;
  files_[first].bytes = end.intact_bytes + end.lost_bytes;
  bytes_ += files_[first].bytes;
}

void Spool::append(Message& message, bool known) {
  const std::lock_guard appending(append_mutex_);
  message.received = next_number_;
  frame_.clear();
  append_spooled(frame_, message);
  const int error = write(frame_);
  note(error);
  if (error) {
    refused_ += 1;
    message.received = -1;
    return;
  }
  next_number_ += 1;
  std::unique_lock lock(mutex_);
  place(message.received, static_cast<std::int64_t>(frame_.size()));
  receipts_.add(message, known);
  const std::optional<std::int64_t> wasteful = wasteful_file();
  lock.unlock();
  if (wasteful) move_on(*wasteful);
}

/// To the end of the newest file, or of a new one. Returns 0 or errno.
int Spool::write(std::span<const std::uint8_t> bytes) {
  const auto size = static_cast<std::int64_t>(bytes.size());
  std::unique_lock lock(mutex_);
  if (waiting_bytes_ + size > options_.max_bytes) return EDQUOT;
  const bool is_full = !broken_ && files_[current_].bytes + size > options_.file_bytes;
  lock.unlock();
  if (broken_ || is_full) {
    const int error = begin_file();
    if (error && broken_) return error;  // otherwise the present one grows on
  }
  return write_to_file(bytes);
}

/// All of it, or the file stays as it was. Returns 0 or errno.
int Spool::write_to_file(std::span<const std::uint8_t> bytes) {
  const int error = options_.disk.write(file_.get(), bytes);
  const std::lock_guard lock(mutex_);
  if (error) {
    broken_ = ::ftruncate(file_.get(), files_[current_].bytes) != 0;
    return error;
  }
  const auto size = static_cast<std::int64_t>(bytes.size());
  files_[current_].bytes += size;
  bytes_ += size;
  unsynced_ = true;
  return 0;
}

/// Returns 0 or errno; then all is as it was.
int Spool::begin_file() {
  std::vector<std::uint8_t> header;
  if (next_number_ == current_ && file_.is_open()) next_number_ += 1;  // all it holds was moved on to it
  const std::int64_t first = next_number_;
  append_spool_header(header, first, journal_segment_);
  const std::string path = spool_path(directory_, first);
  FileHandle file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666));
  if (!file.is_open()) return errno;
  if (const int error = options_.disk.write(file.get(), header)) {
    ::unlink(path.c_str());
    return error;
  }
  const std::lock_guard lock(mutex_);
  if (file_.is_open()) closed_.push_back(std::move(file_));
  file_ = std::move(file);
  broken_ = false;
  const std::int64_t before = std::exchange(current_, first);
  const auto size = static_cast<std::int64_t>(header.size());
  files_[first].path = path;
  files_[first].bytes = size;
  bytes_ += size;
  unsynced_ = true;
  remove_if_settled(before);
  return 0;
}

/// The message lies in the newest file.
void Spool::place(std::int64_t number, std::int64_t bytes) {
  File& file = files_[current_];
  file.waiting += 1;
  file.waiting_bytes += bytes;
  waiting_bytes_ += bytes;
  places_.emplace_hint(places_.end(), number, Place{current_, bytes});
}

void Spool::unplace(std::map<std::int64_t, Place>::iterator found) {
  const Place place = found->second;
  places_.erase(found);
  waiting_bytes_ -= place.bytes;
  File& file = files_[place.file];
  file.waiting -= 1;
  file.waiting_bytes -= place.bytes;
}

void Spool::settle(std::int64_t number) {
  const std::lock_guard lock(mutex_);
  const auto found = places_.find(number);
  if (found == places_.end()) return;
  const std::int64_t file = found->second.file;
  unplace(found);
  remove_if_settled(file);
}

void Spool::remove_if_settled(std::int64_t first) {
  const auto file = files_.find(first);
  if (file == files_.end() || first == current_ || file->second.waiting > 0 || file->second.stays) return;
  ::unlink(file->second.path.c_str());
  bytes_ -= file->second.bytes;
  files_.erase(file);
}

/// Where files take more than twice what waits: the one that holds least of it.
std::optional<std::int64_t> Spool::wasteful_file() const {
  constexpr std::int64_t spare_files = 4;
  if (bytes_ <= 2 * waiting_bytes_ + spare_files * options_.file_bytes) return std::nullopt;
  std::optional<std::int64_t> least;
  for (const auto& [first, file] : files_) {
    if (first == current_ || !file.readable) continue;
    if (!least || file.waiting_bytes < files_.at(*least).waiting_bytes) least = first;
  }
  return least;
}

/// What waits in a file, to the newest one; then it is deleted.
void Spool::move_on(std::int64_t first) {
  std::unique_lock lock(mutex_);
  const auto file = files_.find(first);
  if (file == files_.end()) return;  // settled meanwhile
  file->second.stays = true;
  lock.unlock();
  try {
    for (const SpooledBytes& message : waiting_in(first)) move(message);
    const int error = sync();
    lock.lock();
    files_[first].stays = error != 0;
    remove_if_settled(first);
  } catch (const std::runtime_error& error) {
    lock.lock();
    files_[first].readable = files_[first].stays = false;
    report(error.what());
  }
}

std::vector<Spool::SpooledBytes> Spool::waiting_in(std::int64_t first) const {
  std::vector<SpooledBytes> waiting;
  std::unique_lock lock(mutex_);
  const std::string path = files_.at(first).path;
  lock.unlock();
  read_spool_file(path, [&](Message&& message, auto bytes) {
    const std::lock_guard reading(mutex_);
    const auto place = places_.find(message.received);
    if (place != places_.end() && place->second.file == first)
      waiting.push_back({message.received, {bytes.begin(), bytes.end()}});
  });
  return waiting;
}

/// Throws std::runtime_error where the disk refuses it: it stays where it is.
void Spool::move(const SpooledBytes& message) {
  if (const int error = write(message.bytes)) throw std::runtime_error(errno_text(error));
  const std::lock_guard lock(mutex_);
  const auto found = places_.find(message.number);
  if (found == places_.end()) return;  // settled meanwhile
  unplace(found);
  place(message.number, static_cast<std::int64_t>(message.bytes.size()));
}

void Spool::note(int error) {
  const int before = std::exchange(error_, error);
  if ((before == 0) == (error == 0)) return;
  if (error)
    report(errno_text(error) + "; messages wait in memory only: a crash would lose them");
  else
    report("takes messages again; " + std::to_string(refused_) + " waited in memory only so far");
}

void Spool::finish() {
  const std::lock_guard appending(append_mutex_);
  std::unique_lock lock(mutex_);
  const bool is_over = places_.empty();
  lock.unlock();
  if (is_over) begin_file();
  sync();
}

std::int64_t Spool::waiting() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::int64_t>(places_.size());
}

std::int64_t Spool::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

void Spool::report(const std::string& what) const {
  if (options_.report) options_.report("spool " + directory_ + ": " + what);
}

void Spool::sync_loop(const std::stop_token& stop) {
  std::mutex mutex;
  std::unique_lock waiting(mutex);
  while (!stopped_.wait_for(waiting, stop, options_.sync_interval, [&] { return stop.stop_requested(); }))
    sync();
}

/// Then acknowledges. Returns 0 or errno.
int Spool::sync() {
  const std::lock_guard syncing(sync_mutex_);
  std::unique_lock lock(mutex_);
  if (!std::exchange(unsynced_, false)) return 0;
  std::vector<FileHandle> closed = std::exchange(closed_, {});
  const Receipts receipts = receipts_;
  // A slow disk must not hold up who receives; but it does rather than that nothing is synced, where the
  // process has no descriptor left.
  const FileHandle copy(file_.is_open() ? ::dup(file_.get()) : -1);
  if (copy.is_open()) lock.unlock();
  int error = options_.disk.sync(directory_handle_.get());  // names of new files
  for (std::size_t i = 0; i < closed.size() && !error; ++i) error = options_.disk.sync(closed[i].get());
  if (!error) error = options_.disk.sync(copy.is_open() ? copy.get() : file_.get());
  const bool reported = std::exchange(sync_error_, error) == error;
  if (!error) {
    if (options_.acknowledge) options_.acknowledge(receipts);
    return 0;
  }
  if (!reported) report(errno_text(error) + " on writing to the disk; nothing is acknowledged meanwhile");
  if (!lock.owns_lock()) lock.lock();
  unsynced_ = true;
  std::move(closed.begin(), closed.end(), std::back_inserter(closed_));
  return error;
}

}  // namespace isthmus
