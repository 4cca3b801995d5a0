#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "server/wire/file/file_bytes.hpp"

namespace isthmus {

using Bytes16 = std::array<std::uint8_t, 16>;

/// How far a journal reaches with one of its segments.
struct JournalPlace {
  Bytes16 journal{};               ///< identity; zeros: no segment yet
  std::int32_t segment = 0;        ///< number; 0: none
  Bytes16 header{};                ///< `check` of the segment's header
  std::int64_t next_sequence = 0;  ///< of the entry that would follow
  std::int64_t received = -1;      ///< highest number of a received message; -1: none

  auto members() { return std::tie(journal, segment, header, next_sequence, received); }
};

/// How a segment of a journal begins (lcmtypes/journal_t.lcm).
struct SegmentHeader {
  std::int64_t utime = 0;
  Bytes16 journal{};
  std::int32_t segment = 0;
  std::int64_t first_sequence = 0;
  std::int64_t received = -1;
  Bytes16 secret{};
  Bytes16 previous{};
  Bytes16 check{};  ///< computed when it is written
};

inline constexpr const char* journal_channel = "ISTHMUS_JOURNAL";

/// Of one copy, and of both.
constexpr std::int64_t header_copy_bytes = 28 + 15 + 100;
constexpr std::int64_t segment_header_bytes = 2 * header_copy_bytes;

/// The header of the segment that follows a place, but for its `utime` and `check`. Its secret is drawn, and
/// the journal's identity where there is no segment yet.
SegmentHeader header_after(const JournalPlace& place);

/// Appends both copies, which are the LCM log events 0 and 1, and sets `check`.
void append_segment_header(std::vector<std::uint8_t>& out, SegmentHeader& header);

/// The first copy that is whole; nothing where there is none.
std::optional<SegmentHeader> read_segment_header(FileBytes& file);

/// Whether bytes, fewer than a copy of the header has, can be its beginning: what is left of a first write
/// that was cut off.
bool can_begin_header(std::span<const std::uint8_t> bytes);

}  // namespace isthmus
