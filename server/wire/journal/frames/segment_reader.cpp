#include "server/wire/journal/frames/segment_reader.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "server/wire/journal/frames/log_frame.hpp"

namespace isthmus {
namespace {

SegmentHeader header_of(FileBytes& file) {
  if (const auto header = read_segment_header(file)) return *header;
  throw std::runtime_error(file.path() + ": is no segment of a journal: it has no header of one");
}

/// Whether what follows an offset is a write that was not done to its end: of the header's second copy, or of
/// an entry with its frames.
bool is_torn(FileBytes& file, std::int64_t offset, const Bytes16& secret) {
  const auto tail = file.at(offset, entry_frame_bytes);
  if (offset < segment_header_bytes) return can_begin_header(file.at(offset, header_copy_bytes));
  if (can_begin_entry(tail)) return true;
  const auto entry = parse_entry(tail, secret);
  return entry && offset + entry_frame_bytes + entry->bytes > file.size();
}

}  // namespace

SegmentReader::SegmentReader(const std::string& path)
    : file_(path),
      header_(header_of(file_)),
      next_sequence_(header_.first_sequence),
      received_(header_.received),
      // A first write that was cut off may have left one copy and a part of the other.
      position_(file_.size() < segment_header_bytes ? header_copy_bytes : segment_header_bytes),
      end_(position_) {}

std::optional<Message> SegmentReader::next() {
  if (position_ == end_ && !find_entry()) return std::nullopt;
  offset_ = position_;
  const auto header = parse_log_header(file_.at(position_, static_cast<std::int64_t>(log_header_bytes)));
  if (!header || position_ + header->frame_bytes() > end_)
    throw std::runtime_error(path() + ": the entry before offset " + std::to_string(position_) +
                             " holds what is no event");
  Message message = read_log_frame(*header, file_.at(position_, header->frame_bytes()));
  position_ += header->frame_bytes();
  if (position_ == end_) {
    message.received = entry_received_;
    message.sequence = next_sequence_ - 1;
  }
  return message;
}

bool SegmentReader::find_entry() {
  std::int64_t offset = position_;
  while (offset < size()) {
    if (take_entry(offset)) return true;
    // Not behind the frames that it claims: they may be those that were not written to their end.
    offset = file_.find_word(log_sync_word, offset + 1, size());
  }
  pass_over(size(), 0);
  end_ = position_ = size();
  return false;
}

bool SegmentReader::take_entry(std::int64_t offset) {
  const auto entry = parse_entry(file_.at(offset, entry_frame_bytes), header_.secret);
  if (!entry || entry->sequence < next_sequence_) return false;
  const std::int64_t begin = offset + entry_frame_bytes;
  if (!is_content(*entry, file_.at(begin, entry->bytes))) return false;
  pass_over(offset, entry->sequence - next_sequence_);
  next_sequence_ = entry->sequence + 1;
  received_ = std::max(received_, entry->received);
  entry_received_ = entry->received;
  position_ = begin;
  end_ = begin + entry->bytes;
  return true;
}

void SegmentReader::pass_over(std::int64_t end, std::int64_t missing) {
  if (end > position_ || missing > 0) damage_.push_back({path(), position_, end - position_, missing});
}

std::vector<LogDamage> SegmentReader::take_damage() { return std::exchange(damage_, {}); }

JournalPlace SegmentReader::place() const {
  return {header_.journal, header_.segment, header_.check, next_sequence_, received_};
}

SegmentEnd find_segment_end(const std::string& path) {
  SegmentReader reader(path);
  SegmentEnd end;
  end.bytes = reader.end();
  while (reader.next()) end.bytes = reader.end();
  end.place = reader.place();
  FileBytes file(path);
  if (is_torn(file, end.bytes, reader.header().secret)) end.torn_bytes = file.size() - end.bytes;
  return end;
}

}  // namespace isthmus
