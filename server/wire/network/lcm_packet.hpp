#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace isthmus {

/// Longest channel name that LCM has.
constexpr std::size_t max_channel_characters = 63;

/// One datagram of LCM's UDP multicast protocol: a short message (LC02), which is whole, or one fragment of a
/// longer one (LC03). Source: the protocol's description in LCM's documentation. It refers to the datagram's
/// bytes.
struct LcmPacket {
  std::uint32_t sequence = 0;          ///< of the message, counted by its sender
  std::string_view channel;            ///< of a short message or a first fragment
  std::span<const std::uint8_t> data;  ///< the message, or this fragment's part of it
  bool is_fragment = false;
  std::uint32_t message_bytes = 0;  ///< of the whole message
  std::uint32_t offset = 0;         ///< of `data` in the message
  std::uint16_t number = 0;         ///< of this fragment, from 0
  std::uint16_t fragments = 1;      ///< in the message

  bool names_channel() const { return number == 0; }
};

/// Nothing for a datagram that is none of LCM's or contradicts itself: cut short, a channel without an end or
/// too long, a fragment with a number that its message does not have, outside its message, or empty.
std::optional<LcmPacket> parse_lcm_packet(std::span<const std::uint8_t> datagram);

}  // namespace isthmus
