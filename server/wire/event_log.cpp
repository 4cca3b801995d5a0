#include "server/wire/event_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "server/wire/file_bytes.hpp"
#include "server/wire/log_frame.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

/// The file itself, or the segments of a journal directory in order of name.
std::vector<std::string> log_files(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<std::string> files;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".lcm") files.push_back(entry->path().string());
  }
  if (error) throw std::runtime_error(path + ": " + error.message());
  if (files.empty()) throw std::runtime_error(path + ": no journal (no *.lcm in this directory)");
  std::sort(files.begin(), files.end());
  return files;
}

/// One file of a log: finds the next intact event from an offset on.
class LogFileReader {
 public:
  explicit LogFileReader(const std::string& path) : file_(path) {}

  const std::string& path() const { return file_.path(); }
  std::int64_t size() const { return file_.size(); }
  std::int64_t position() const { return position_; }
  std::int64_t skipped() const { return skipped_; }

  /// Whether it begins as a log does, or is empty.
  bool begins_as_log() {
    const auto start = file_.at(0, 4);
    for (std::size_t i = 0; i < start.size(); ++i) {
      if (start[i] != static_cast<std::uint8_t>(log_sync_word >> (24 - 8 * i))) return false;
    }
    return true;
  }

  /// Moves to the next intact event, counting what is passed over; nothing at the end of the file.
  std::optional<LogHeader> find() {
    while (position_ < size()) {
      const std::optional<LogHeader> header = header_at(position_);
      if (header && is_intact(*header)) return header;
      const std::int64_t next = file_.find_word(log_sync_word, position_ + 1, size());
      skipped_ += next - position_;
      position_ = next;
    }
    return std::nullopt;
  }

  /// On to what follows the event found.
  void pass(const LogHeader& header) { position_ += header.frame_bytes(); }

  /// The event found, and on to what follows it.
  Message take(const LogHeader& header) {
    const auto frame = file_.at(position_, header.frame_bytes());
    if (static_cast<std::int64_t>(frame.size()) != header.frame_bytes()) {
      throw std::runtime_error(path() + ": became shorter while it was read");
    }
    const auto channel = frame.subspan(log_header_bytes, static_cast<std::size_t>(header.channel_bytes));
    const auto data = frame.subspan(log_header_bytes + channel.size());
    pass(header);
    return {header.utime, {channel.begin(), channel.end()}, {data.begin(), data.end()}};
  }

 private:
  std::optional<LogHeader> header_at(std::int64_t offset) {
    return parse_log_header(file_.at(offset, static_cast<std::int64_t>(log_header_bytes)));
  }

  /// Whether the event at the position can be taken at its word. A frame that ends at its successor or at the
  /// end of the file can. Otherwise either its own lengths are damaged, or only what follows it: they are its
  /// own if another event begins inside it. Where the successor's number does not follow on, the frame may
  /// have swallowed an event; then the event inside must bear the number that does.
  bool is_intact(const LogHeader& header) {
    const std::int64_t end = position_ + header.frame_bytes();
    if (end > size()) return false;
    const std::optional<LogHeader> next = header_at(end);
    if (next && next->number == header.number + 1) return true;
    const bool ends_well = end == size() || next;
    for (std::int64_t inner = position_ + 1;; ++inner) {
      inner = file_.find_word(log_sync_word, inner, end);
      if (inner == end) return true;
      const std::optional<LogHeader> inside = header_at(inner);
      if (inside && (!ends_well || inside->number == header.number + 1)) return false;
    }
  }

  FileBytes file_;
  std::int64_t position_ = 0;
  std::int64_t skipped_ = 0;
};

}  // namespace

struct EventLogReader::State {
  std::vector<std::string> files;
  std::vector<std::int64_t> sizes;
  std::size_t current = 0;
  std::optional<LogFileReader> file;
  std::optional<LogHeader> found;  ///< the next event, at the file's position
  std::int64_t skipped_before = 0;
  std::int64_t number = -1;
  std::int64_t offset = 0;
  std::string event_file;

  /// Whether any of the files begins as a log does, or is empty.
  bool open(std::vector<std::string> names) {
    files = std::move(names);
    if (files.empty()) return true;
    bool begins_as_log = false;
    for (const std::string& name : files) {
      LogFileReader opened(name);
      sizes.push_back(opened.size());
      begins_as_log = begins_as_log || opened.begins_as_log();
    }
    event_file = files.front();
    file.emplace(files.front());
    find();
    return begins_as_log;
  }

  /// Finds the next intact event, in this file or those that follow.
  void find() {
    while (!(found = file->find()) && current + 1 < files.size()) {
      skipped_before += file->skipped();
      file.emplace(files[++current]);
    }
  }
};

EventLogReader::EventLogReader(const std::string& path) : state_(std::make_unique<State>()) {
  const bool begins_as_log = state_->open(log_files(path));
  if (!state_->found && !begins_as_log) {
    throw std::runtime_error(path + ": not an LCM event log (no event found in it)");
  }
}

EventLogReader::EventLogReader(std::vector<std::string> files) : state_(std::make_unique<State>()) {
  state_->open(std::move(files));
}

EventLogReader::~EventLogReader() = default;
EventLogReader::EventLogReader(EventLogReader&&) noexcept = default;
EventLogReader& EventLogReader::operator=(EventLogReader&&) noexcept = default;

std::optional<Message> EventLogReader::next() {
  State& state = *state_;
  if (!state.found) return std::nullopt;
  state.number += 1;
  state.offset = state.file->position();
  state.event_file = state.file->path();
  Message message = state.file->take(*state.found);
  state.find();
  return message;
}

std::string EventLogReader::file() const { return state_->event_file; }
std::int64_t EventLogReader::event_number() const { return state_->number; }
std::int64_t EventLogReader::offset() const { return state_->offset; }
std::int64_t EventLogReader::skipped_bytes() const {
  return state_->skipped_before + (state_->file ? state_->file->skipped() : 0);
}

double EventLogReader::progress() const {
  if (!state_->file) return 1;
  const auto& sizes = state_->sizes;
  const std::int64_t all = std::accumulate(sizes.begin(), sizes.end(), std::int64_t{0});
  const auto current = sizes.begin() + static_cast<std::ptrdiff_t>(state_->current);
  const std::int64_t done = std::accumulate(sizes.begin(), current, state_->file->position());
  return all > 0 ? std::min(1.0, static_cast<double>(done) / static_cast<double>(all)) : 1.0;
}

LogEnd find_log_end(const std::string& name) {
  LogFileReader file(name);
  std::int64_t end = 0;
  while (const std::optional<LogHeader> header = file.find()) {
    file.pass(*header);
    end = file.position();
  }
  return {end, file.size() - end};
}

struct EventLogWriter::State {
  std::string path;
  std::string temporary;
  FileHandle file;
  std::vector<std::uint8_t> buffer;
  std::int64_t number = 0;

  [[noreturn]] void fail(int error) const { throw std::runtime_error(path + ": " + errno_text(error)); }

  void flush() {
    if (const int error = write_all(file.get(), buffer)) fail(error);
    buffer.clear();
  }
};

EventLogWriter::EventLogWriter(const std::string& path) : state_(std::make_unique<State>()) {
  state_->path = path;
  state_->temporary = path + ".partial";
  state_->file =
      FileHandle(::open(state_->temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!state_->file.is_open()) state_->fail(errno);
}

EventLogWriter::~EventLogWriter() {
  if (state_->file.is_open()) ::unlink(state_->temporary.c_str());
}

void EventLogWriter::write(const Message& message) {
  append_log_frame(state_->buffer, state_->number, message);
  state_->number += 1;
  if (state_->buffer.size() >= 1 << 20) state_->flush();
}

void EventLogWriter::finish() {
  State& state = *state_;
  state.flush();
  if (::fsync(state.file.get()) != 0) state.fail(errno);
  if (::rename(state.temporary.c_str(), state.path.c_str()) != 0) state.fail(errno);
  state.file.close();
}

}  // namespace isthmus
