#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "server/wire/network/reassembly.hpp"

/// Input: datagrams, each behind a byte for its sender (upper half) and the time since the one before (lower
/// half, in eighths of a second) and two bytes for its length. Whatever they are, what comes out is on a
/// wanted channel and within the bounds, and so is what is held.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isthmus::ReassemblyLimits limits;
  limits.message_bytes = 4096;
  limits.fragments = 64;
  limits.messages = 16;
  limits.messages_of_sender = 4;
  limits.bytes = 16 * 1024;
  const auto wants = [](std::string_view channel) { return channel.starts_with("R"); };
  isthmus::Reassembly reassembly(
      {wants,
       [&](std::int64_t, std::string_view channel, std::span<const std::uint8_t> bytes) {
         if (!wants(channel) || channel.size() > isthmus::max_channel_characters) std::abort();
         if (bytes.size() > 65'536) std::abort();
       },
       [](std::string_view, isthmus::DropReason reason) {
         if (reason == isthmus::DropReason::none) std::abort();
       }},
      limits);
  std::int64_t now_us = 0;
  for (std::span input(data, size); input.size() >= 3;) {
    const std::size_t length = std::size_t{input[1]} << 8 | input[2];
    const std::uint8_t head = input[0];
    now_us += (head & 15) * 125'000;
    input = input.subspan(3);
    const auto datagram = input.first(std::min(length, input.size()));
    reassembly.take({1, static_cast<std::uint16_t>(head >> 4)}, datagram, 1, now_us);
    if (reassembly.bytes() > limits.bytes || reassembly.messages() > limits.messages) std::abort();
    input = input.subspan(datagram.size());
  }
  return 0;
}
