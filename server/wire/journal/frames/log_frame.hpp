#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/wire/message/message.hpp"

namespace isthmus {

/// The frame of one event in an LCM log: a header of 28 bytes, big-endian (sync word, int64 event number,
/// int64 microseconds, int32 channel length, int32 data length), then the channel, then the data.
struct LogHeader {
  std::int64_t number = 0;
  std::int64_t utime = 0;
  std::int32_t channel_bytes = 0;
  std::int32_t data_bytes = 0;

  std::int64_t frame_bytes() const;
};

constexpr std::uint32_t log_sync_word = 0xEDA1DA01;
constexpr std::size_t log_header_bytes = 28;
constexpr std::int32_t max_channel_bytes = 999;  ///< as liblcm's own reader
constexpr std::int32_t max_data_bytes = 256 * 1024 * 1024;

/// Nothing where the bytes are too few, begin otherwise than with the sync word, or hold lengths beyond the
/// caps.
std::optional<LogHeader> parse_log_header(std::span<const std::uint8_t> bytes);

/// The event in a whole frame with this header.
Message read_log_frame(const LogHeader& header, std::span<const std::uint8_t> frame);

void append_log_frame(std::vector<std::uint8_t>& out, std::int64_t number, const Message& message);

}  // namespace isthmus
