#include "server/wire/journal/event_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "server/wire/file/file_bytes.hpp"
#include "server/wire/journal/drop_record.hpp"
#include "server/wire/journal/frames/log_frame.hpp"
#include "server/wire/journal/frames/segment_reader.hpp"
#include "server/wire/journal/log_file.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

bool is_segment(const std::string& path) {
  FileBytes file(path);
  return read_segment_header(file).has_value();
}

/// What readers take instead of an event that is set aside.
Message in_place_of(const Message& message, const SetAside& event) {
  Message record = encode_drops(message.utime, {{event.robot, {{DropReason::set_aside, {1, {}}}}}});
  record.received = message.received;
  record.sequence = message.sequence;
  return record;
}

constexpr const char* not_verified =
    ": it holds a header of a journal's segment that is damaged, or was recorded anew: nothing can be "
    "verified";

}  // namespace

struct EventLogReader::State {
  std::vector<std::string> files;
  bool verified = false;  ///< they are segments
  std::vector<std::int64_t> sizes;
  std::size_t opened = 0;  ///< of the files; the last of them is read
  std::variant<std::monostate, LogFile, SegmentReader> current;
  std::optional<JournalPlace> place;  ///< of what was read before; none: unknown
  std::int64_t number = -1;
  std::int64_t skipped_bytes = 0;
  std::int64_t missing_events = 0;
  std::vector<std::string> warnings;
  LogDamage more;  ///< of a file whose first damage was reported
  std::int64_t more_places = 0;
  SetAsideEvents set_aside;

  /// Calls `what` with the present file; `otherwise` where there is none.
  template <class Result, class What>
  Result with_file(Result otherwise, const What& what) const {
    if (const auto* log = std::get_if<LogFile>(&current)) return what(*log);
    if (const auto* segment = std::get_if<SegmentReader>(&current)) return what(*segment);
    return otherwise;
  }

  void measure() {
    for (const std::string& file : files) sizes.push_back(FileBytes(file).size());
  }

  std::optional<Message> next() {
    while (true) {
      std::optional<Message> message;
      if (auto* log = std::get_if<LogFile>(&current)) {
        message = log->next();
        note(log->take_damage());
      } else if (auto* segment = std::get_if<SegmentReader>(&current)) {
        message = segment->next();
        note(segment->take_damage());
      }
      if (message) return message;
      if (opened == files.size()) {
        tell_more();
        return std::nullopt;
      }
      open_next();
    }
  }

  void open_next() {
    const std::string& path = files[opened++];
    if (!verified) {
      current.emplace<LogFile>(path);
      return;
    }
    if (const auto* before = std::get_if<SegmentReader>(&current)) place = before->place();
    SegmentReader& segment = current.emplace<SegmentReader>(path);
    if (!place) return;
    const std::int64_t missing = segment.header().first_sequence - place->next_sequence;
    if (missing > 0) note({{path, 0, 0, missing}});
    segment.expect(std::max(segment.header().first_sequence, place->next_sequence));
  }

  /// The first damage of a file is reported at once, all others of that file in one line at its end.
  void note(const std::vector<LogDamage>& damage) {
    for (const LogDamage& one : damage) {
      skipped_bytes += one.bytes;
      missing_events += one.missing;
      if (one.file == more.file) {
        more.bytes += one.bytes;
        more.missing += one.missing;
        more_places += 1;
        continue;
      }
      tell_more();
      more = {one.file, 0, 0, 0};
      warnings.push_back(text_of(one));
    }
  }

  void tell_more() {
    if (more_places > 0) warnings.push_back(text_of_more(more, more_places));
    more_places = 0;
    more = {};
  }
};

EventLogReader::EventLogReader(const std::string& path) : state_(std::make_unique<State>()) {
  State& state = *state_;
  std::error_code error;
  if (fs::is_directory(path, error)) {
    const JournalView journal = view_journal(path);
    if (journal.segments.empty() && journal.unbegun.empty())
      throw std::runtime_error(path + ": no journal (no *.lcm in this directory)");
    *this = EventLogReader(journal, {});
    return;
  }
  state.files = {path};
  state.verified = is_segment(path);
  state.measure();
  state.open_next();
  auto* log = std::get_if<LogFile>(&state.current);
  if (log == nullptr) return;
  if (!log->has_next() && !log->begins_as_log())
    throw std::runtime_error(path + ": not an LCM event log (no event found in it)");
  if (const auto first = LogFile(path).next(); first && first->channel == journal_channel)
    state.warnings.push_back(path + not_verified);
}

EventLogReader::EventLogReader(const JournalView& journal, const JournalPlace& from, int last)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  for (const JournalSegment& segment : journal.segments) {
    if (segment.number > from.segment && segment.number <= last) state.files.push_back(segment.path);
  }
  state.verified = journal.verified;
  state.place = from;
  state.warnings = journal.warnings;
  state.set_aside = journal.set_aside;
  state.measure();
  if (!state.files.empty()) state.open_next();
}

EventLogReader::~EventLogReader() = default;
EventLogReader::EventLogReader(EventLogReader&&) noexcept = default;
EventLogReader& EventLogReader::operator=(EventLogReader&&) noexcept = default;

std::optional<Message> EventLogReader::next() {
  std::optional<Message> message = state_->next();
  if (!message) return message;
  state_->number += 1;
  if (const auto found = state_->set_aside.find(message->sequence); found != state_->set_aside.end())
    return in_place_of(*message, found->second);
  return message;
}

std::string EventLogReader::file() const {
  return state_->with_file(std::string(), [](const auto& file) { return file.path(); });
}
std::int64_t EventLogReader::event_number() const { return state_->number; }
std::int64_t EventLogReader::offset() const {
  return state_->with_file(std::int64_t{0}, [](const auto& file) { return file.offset(); });
}
std::int64_t EventLogReader::skipped_bytes() const { return state_->skipped_bytes; }
std::int64_t EventLogReader::missing_events() const { return state_->missing_events; }
std::vector<std::string> EventLogReader::take_warnings() { return std::exchange(state_->warnings, {}); }

JournalPlace EventLogReader::place() const {
  if (const auto* segment = std::get_if<SegmentReader>(&state_->current)) return segment->place();
  return state_->place.value_or(JournalPlace());
}

double EventLogReader::progress() const {
  const auto& sizes = state_->sizes;
  const std::int64_t all = std::accumulate(sizes.begin(), sizes.end(), std::int64_t{0});
  if (state_->opened == 0 || all == 0) return 1;
  const auto current = sizes.begin() + static_cast<std::ptrdiff_t>(state_->opened) - 1;
  const std::int64_t position =
      state_->with_file(std::int64_t{0}, [](const auto& file) { return file.position(); });
  const std::int64_t done = std::accumulate(sizes.begin(), current, position);
  return std::min(1.0, static_cast<double>(done) / static_cast<double>(all));
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
