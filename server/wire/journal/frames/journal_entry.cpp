#include "server/wire/journal/frames/journal_entry.hpp"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "isthmus/entry_t.hpp"
#include "server/wire/file/digest.hpp"
#include "server/wire/journal/frames/log_frame.hpp"
#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

constexpr std::string_view entry_channel = "ISTHMUS_ENTRY";
constexpr std::size_t entry_data_bytes = 52;
constexpr std::size_t entry_check_bytes = 16;
constexpr std::size_t data_offset = log_header_bytes + entry_channel.size();
static_assert(entry_frame_bytes == data_offset + entry_data_bytes);

std::array<std::uint8_t, 8> digest_of(std::span<const std::uint8_t> frames) {
  return first_bytes<8>(sha256(frames));
}

}  // namespace

void append_entry(std::vector<std::uint8_t>& out, std::int64_t number, std::int64_t utime,
                  const Bytes16& secret, JournalEntry entry, std::span<const std::uint8_t> frames) {
  entry_t message{};
  message.sequence = entry.sequence;
  message.received = entry.received;
  message.bytes = static_cast<std::int32_t>(frames.size());
  const auto content = digest_of(frames);
  std::memcpy(message.content, content.data(), content.size());
  std::vector<std::uint8_t> data = encoded(message);
  const std::size_t checked = data.size() - entry_check_bytes;
  const auto check = first_bytes<entry_check_bytes>(hmac_sha256(secret, std::span(data).first(checked)));
  std::memcpy(data.data() + checked, check.data(), check.size());
  append_log_frame(out, number, {utime, std::string(entry_channel), std::move(data)});
  out.insert(out.end(), frames.begin(), frames.end());
}

std::optional<JournalEntry> parse_entry(std::span<const std::uint8_t> frame, const Bytes16& secret) {
  const std::optional<LogHeader> header = parse_log_header(frame);
  if (!header || frame.size() != static_cast<std::size_t>(entry_frame_bytes) ||
      header->channel_bytes != static_cast<std::int32_t>(entry_channel.size()) ||
      header->data_bytes != static_cast<std::int32_t>(entry_data_bytes) ||
      !std::equal(entry_channel.begin(), entry_channel.end(), frame.begin() + log_header_bytes))
    return std::nullopt;
  const auto data = frame.subspan(data_offset);
  const auto checked = data.first(data.size() - entry_check_bytes);
  if (!begins_with(hmac_sha256(secret, checked), data.last(entry_check_bytes))) return std::nullopt;
  entry_t message{};
  if (message.decode(data.data(), 0, static_cast<int>(data.size())) != static_cast<int>(data.size()) ||
      message.bytes <= 0)
    return std::nullopt;
  JournalEntry entry{message.sequence, message.received, message.bytes};
  std::copy_n(message.content, entry.content.size(), entry.content.begin());
  return entry;
}

bool is_content(const JournalEntry& entry, std::span<const std::uint8_t> frames) {
  return frames.size() == static_cast<std::size_t>(entry.bytes) && digest_of(frames) == entry.content;
}

bool can_begin_entry(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> any;
  append_entry(any, 0, 0, {}, {}, {});
  // The sync word, the lengths, the channel and the fingerprint are known beforehand.
  const auto known = [](std::size_t i) { return i < 4 || (i >= 20 && i < data_offset + 8); };
  for (std::size_t i = 0; i < std::min(bytes.size(), any.size()); ++i) {
    if (known(i) && bytes[i] != any[i]) return false;
  }
  return bytes.size() < static_cast<std::size_t>(entry_frame_bytes);
}

}  // namespace isthmus
