#include "server/wire/journal/log_file.hpp"

#include <algorithm>
#include <utility>

#include "server/wire/journal/signature.hpp"

namespace isthmus {

bool LogFile::begins_as_log() {
  const auto start = file_.at(0, 4);
  for (std::size_t i = 0; i < start.size(); ++i) {
    if (start[i] != static_cast<std::uint8_t>(log_sync_word >> (24 - 8 * i))) return false;
  }
  return true;
}

std::optional<Message> LogFile::next() {
  const std::optional<LogHeader> header = find();
  if (!header) return std::nullopt;
  offset_ = position_;
  position_ += header->frame_bytes();
  return read_log_frame(*header, file_.at(offset_, header->frame_bytes()));
}

std::vector<LogDamage> LogFile::take_damage() { return std::exchange(damage_, {}); }

/// Moves to the next intact event; nothing at the end of the file.
std::optional<LogHeader> LogFile::find() {
  const std::int64_t begin = position_;
  std::optional<LogHeader> found;
  while (position_ < size()) {
    found = header_at(position_);
    if (found && is_intact(*found)) break;
    const bool torn = found && position_ + found->frame_bytes() > size() && knows_its_length(*found);
    position_ = torn ? size() : file_.find_word(log_sync_word, position_ + 1, size());
    found.reset();
  }
  if (position_ > begin) damage_.push_back({path(), begin, position_ - begin});
  return found;
}

std::optional<LogHeader> LogFile::header_at(std::int64_t offset) {
  return parse_log_header(file_.at(offset, static_cast<std::int64_t>(log_header_bytes)));
}

/// Whether the event at the position can be taken at its word. Where its successor's number does not follow
/// on, it may have swallowed an event; then the event inside must bear the number that does.
bool LogFile::is_intact(const LogHeader& header) {
  const std::int64_t end = position_ + header.frame_bytes();
  if (end >= size()) return end == size();
  const std::optional<LogHeader> next = header_at(end);
  if (next && next->number == header.number + 1) return true;
  if (knows_its_length(header)) return true;
  for (std::int64_t inner = position_ + 1;; ++inner) {
    inner = file_.find_word(log_sync_word, inner, end);
    if (inner == end) return true;
    const std::optional<LogHeader> inside = header_at(inner);
    if (inside && (!next || inside->number == header.number + 1)) return false;
  }
}

bool LogFile::knows_its_length(const LogHeader& header) {
  const std::int64_t begin = position_ + static_cast<std::int64_t>(log_header_bytes) + header.channel_bytes;
  const auto data = file_.at(begin, header.data_bytes);
  return may_be_input(data, header.data_bytes) || may_be_counters(data, header.data_bytes);
}

}  // namespace isthmus
