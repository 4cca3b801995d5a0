#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/wire/journal/frames/segment_header.hpp"

namespace isthmus {

/// What stands in a journal before each event (lcmtypes/entry_t.lcm).
struct JournalEntry {
  std::int64_t sequence = 0;
  std::int64_t received = -1;
  std::int32_t bytes = 0;                 ///< of the frames that follow
  std::array<std::uint8_t, 8> content{};  ///< computed when it is written
};

constexpr std::int64_t entry_frame_bytes = 28 + 13 + 52;

/// Appends the entry of an event's frames, as the LCM log event of a number and a time; then the frames.
void append_entry(std::vector<std::uint8_t>& out, std::int64_t number, std::int64_t utime,
                  const Bytes16& secret, JournalEntry entry, std::span<const std::uint8_t> frames);

/// The entry in these bytes, which are as many as an entry's frame has; nothing where they are none of the
/// segment with this secret.
std::optional<JournalEntry> parse_entry(std::span<const std::uint8_t> frame, const Bytes16& secret);

/// Whether the frames are those that were written behind the entry.
bool is_content(const JournalEntry& entry, std::span<const std::uint8_t> frames);

/// Whether bytes, fewer than an entry's frame has, can be its beginning.
bool can_begin_entry(std::span<const std::uint8_t> bytes);

}  // namespace isthmus
