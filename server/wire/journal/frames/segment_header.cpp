#include "server/wire/journal/frames/segment_header.hpp"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "isthmus/journal_t.hpp"
#include "server/wire/file/digest.hpp"
#include "server/wire/journal/frames/log_frame.hpp"
#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

constexpr std::string_view segment_header_channel = journal_channel;
constexpr std::size_t segment_header_data_bytes = 100;
constexpr std::size_t check_offset = segment_header_data_bytes - sizeof(Bytes16);
static_assert(header_copy_bytes ==
              log_header_bytes + segment_header_channel.size() + segment_header_data_bytes);

void copy(const Bytes16& from, std::uint8_t* to) { std::memcpy(to, from.data(), from.size()); }

Bytes16 copy_of(const std::uint8_t* from) {
  Bytes16 bytes{};
  std::memcpy(bytes.data(), from, bytes.size());
  return bytes;
}

Message message_of(SegmentHeader& header) {
  journal_t message{};
  message.utime = header.utime;
  copy(header.journal, message.journal);
  message.segment = header.segment;
  message.first_sequence = header.first_sequence;
  message.received = header.received;
  copy(header.secret, message.secret);
  copy(header.previous, message.previous);
  std::vector<std::uint8_t> bytes = encoded(message);
  header.check = first_bytes<16>(sha256(std::span(bytes).first(check_offset)));
  copy(header.check, bytes.data() + check_offset);
  return {header.utime, std::string(segment_header_channel), std::move(bytes)};
}

/// A whole copy, in its LCM log frame.
std::optional<SegmentHeader> parse_copy(std::span<const std::uint8_t> frame) {
  const std::optional<LogHeader> log_header = parse_log_header(frame);
  if (!log_header || frame.size() != header_copy_bytes || log_header->frame_bytes() != header_copy_bytes)
    return std::nullopt;
  const auto name = frame.subspan(log_header_bytes, segment_header_channel.size());
  const auto data = frame.subspan(log_header_bytes + segment_header_channel.size());
  journal_t message{};
  if (!std::equal(name.begin(), name.end(), segment_header_channel.begin()) ||
      message.decode(data.data(), 0, static_cast<int>(data.size())) != static_cast<int>(data.size()))
    return std::nullopt;
  if (!begins_with(sha256(data.first(check_offset)), message.check) || message.utime != log_header->utime)
    return std::nullopt;
  return SegmentHeader{
      message.utime,    copy_of(message.journal), message.segment,           message.first_sequence,
      message.received, copy_of(message.secret),  copy_of(message.previous), copy_of(message.check)};
}

}  // namespace

SegmentHeader header_after(const JournalPlace& place) {
  SegmentHeader header;
  header.journal = place.segment == 0 ? random_bytes() : place.journal;
  header.segment = place.segment + 1;
  header.first_sequence = place.next_sequence;
  header.received = place.received;
  header.secret = random_bytes();
  header.previous = place.header;
  return header;
}

void append_segment_header(std::vector<std::uint8_t>& out, SegmentHeader& header) {
  const Message message = message_of(header);
  append_log_frame(out, 0, message);
  append_log_frame(out, 1, message);
}

std::optional<SegmentHeader> read_segment_header(FileBytes& file) {
  for (const std::int64_t offset : {std::int64_t{0}, header_copy_bytes}) {
    if (const auto header = parse_copy(file.at(offset, header_copy_bytes))) return header;
  }
  return std::nullopt;
}

bool can_begin_header(std::span<const std::uint8_t> bytes) {
  SegmentHeader any;
  std::vector<std::uint8_t> copies;
  append_segment_header(copies, any);
  // The sync word, the lengths, the channel and the fingerprint are known beforehand.
  const auto known = [](std::size_t i) {
    return i < 4 || (i >= 20 && i < log_header_bytes + segment_header_channel.size() + 8);
  };
  for (std::size_t i = 0; i < std::min(bytes.size(), copies.size()); ++i) {
    if (known(i) && bytes[i] != copies[i]) return false;
  }
  return bytes.size() < static_cast<std::size_t>(header_copy_bytes);
}

}  // namespace isthmus
