#include "server/wire/journal/frames/log_frame.hpp"

#include <stdexcept>

#include "server/wire/message/byte_check.hpp"

namespace isthmus {
namespace {

template <class Unsigned>
void append_big_endian(std::vector<std::uint8_t>& out, Unsigned value) {
  for (int shift = static_cast<int>(sizeof(Unsigned)) * 8 - 8; shift >= 0; shift -= 8) {
    out.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

}  // namespace

std::int64_t LogHeader::frame_bytes() const {
  return static_cast<std::int64_t>(log_header_bytes) + channel_bytes + data_bytes;
}

std::optional<LogHeader> parse_log_header(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < log_header_bytes) return std::nullopt;
  if (static_cast<std::uint32_t>(read_int32(bytes)) != log_sync_word) return std::nullopt;
  const LogHeader header{read_int64(bytes.subspan(4)), read_int64(bytes.subspan(12)),
                         read_int32(bytes.subspan(20)), read_int32(bytes.subspan(24))};
  const bool plausible = header.channel_bytes > 0 && header.channel_bytes <= max_channel_bytes &&
                         header.data_bytes >= 0 && header.data_bytes <= max_data_bytes;
  return plausible ? std::optional(header) : std::nullopt;
}

Message read_log_frame(const LogHeader& header, std::span<const std::uint8_t> frame) {
  if (static_cast<std::int64_t>(frame.size()) != header.frame_bytes())
    throw std::runtime_error("a log became shorter while it was read");
  const auto channel = frame.subspan(log_header_bytes, static_cast<std::size_t>(header.channel_bytes));
  const auto data = frame.subspan(log_header_bytes + channel.size());
  return {header.utime, {channel.begin(), channel.end()}, {data.begin(), data.end()}};
}

void append_log_frame(std::vector<std::uint8_t>& out, std::int64_t number, const Message& message) {
  out.reserve(out.size() + log_header_bytes + message.channel.size() + message.bytes.size());
  append_big_endian(out, log_sync_word);
  append_big_endian(out, static_cast<std::uint64_t>(number));
  append_big_endian(out, static_cast<std::uint64_t>(message.utime));
  append_big_endian(out, static_cast<std::uint32_t>(message.channel.size()));
  append_big_endian(out, static_cast<std::uint32_t>(message.bytes.size()));
  out.insert(out.end(), message.channel.begin(), message.channel.end());
  out.insert(out.end(), message.bytes.begin(), message.bytes.end());
}

}  // namespace isthmus
