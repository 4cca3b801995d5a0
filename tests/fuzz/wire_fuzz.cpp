#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "server/wire/message/message.hpp"

/// Input: one byte that chooses the channel, then the message. Whatever it is, it is refused with a reason,
/// or it is an event that can be written and read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::array channels = {
      "R1_ROBOT",        "R1_ODOMETRY",           "R1_SCAN",      "R1_SIGHTING",        "ISTHMUS_TAG",
      "ISTHMUS_COMMAND", "ISTHMUS_CONFIGURATION", "ISTHMUS_TICK", "ISTHMUS_ANNOTATION", "R1_INITIAL_POSE"};
  if (size == 0) return 0;
  const isthmus::ChannelNames configured;
  const std::span bytes(data + 1, size - 1);
  const auto decoded = isthmus::decode(configured, channels[data[0] % channels.size()], bytes, 1);
  if (decoded.event.has_value() != (decoded.reason == isthmus::DropReason::none)) std::abort();
  if (!decoded.event) return 0;
  const isthmus::Message again = isthmus::encode(*decoded.event);
  if (!isthmus::decode(configured, again.channel, again.bytes, again.utime).event) std::abort();
  return 0;
}
