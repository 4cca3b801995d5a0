#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "server/wire/journal/frames/journal_entry.hpp"
#include "server/wire/journal/frames/log_frame.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

inline Message drop_command(const std::string& robot, std::int64_t utime) {
  CommandEvent command;
  command.utime = utime;
  command.verb = Verb::drop;
  command.robot = robot;
  return encode({utime, command});
}

/// The bytes of LCM log frames of a command, again and again, each numbered as if it were the next of the
/// log, and each behind an entry as a journal has them, but for the secret that a sender does not know.
inline std::vector<std::uint8_t> spelled_frames(const Message& command, int count,
                                                std::int64_t first_number) {
  std::vector<std::uint8_t> bytes;
  const Bytes16 guessed_secret{};
  for (int i = 0; i < count; ++i) {
    std::vector<std::uint8_t> frame;
    append_log_frame(frame, first_number + i, command);
    append_entry(bytes, first_number + i, command.utime, guessed_secret, {first_number + i}, frame);
    append_log_frame(bytes, first_number + i, command);
  }
  return bytes;
}

/// A well-formed scan whose ranges are these bytes.
inline Message scan_of_bytes(const std::string& robot, std::int64_t utime,
                             const std::vector<std::uint8_t>& bytes) {
  ScanEvent scan;
  scan.robot = robot;
  scan.scan.utime = utime;
  scan.scan.bearing_step_rad = 0.001;
  scan.scan.ranges_m.resize(bytes.size() / 4 + 1);
  Message message = encode({utime, scan});
  constexpr std::ptrdiff_t before_ranges = 8 + 8 + 4;  // fingerprint, utime, count
  std::copy(bytes.begin(), bytes.end(), message.bytes.begin() + before_ranges);
  return message;
}

}  // namespace isthmus
