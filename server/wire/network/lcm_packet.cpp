#include "server/wire/network/lcm_packet.hpp"

#include <algorithm>

namespace isthmus {
namespace {

constexpr std::uint32_t short_magic = 0x4c433032;     // "LC02"
constexpr std::uint32_t fragment_magic = 0x4c433033;  // "LC03"

/// Reads big-endian numbers and a channel off the front of a datagram; fails for good where it ends too
/// early.
class PacketReader {
 public:
  explicit PacketReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  std::uint32_t number(std::size_t bytes) {
    if (rest_.size() < bytes) return fail();
    std::uint32_t value = 0;
    for (const std::uint8_t byte : rest_.first(bytes)) value = value << 8 | byte;
    rest_ = rest_.subspan(bytes);
    return value;
  }

  std::string_view channel() {
    const auto end = std::find(rest_.begin(), rest_.end(), std::uint8_t{0});
    const auto length = static_cast<std::size_t>(end - rest_.begin());
    if (end == rest_.end() || length > max_channel_characters) return fail(), "";
    const std::string_view name(reinterpret_cast<const char*>(rest_.data()), length);
    rest_ = rest_.subspan(length + 1);
    return name;
  }

  std::span<const std::uint8_t> rest() const { return rest_; }
  bool failed() const { return failed_; }

 private:
  std::uint32_t fail() {
    failed_ = true;
    rest_ = {};
    return 0;
  }

  std::span<const std::uint8_t> rest_;
  bool failed_ = false;
};

bool is_consistent(const LcmPacket& fragment) {
  if (fragment.number >= fragment.fragments) return false;
  if (std::uint64_t{fragment.offset} + fragment.data.size() > fragment.message_bytes) return false;
  if (fragment.number == 0) return fragment.offset == 0;
  return !fragment.data.empty();
}

}  // namespace

std::optional<LcmPacket> parse_lcm_packet(std::span<const std::uint8_t> datagram) {
  PacketReader reader(datagram);
  LcmPacket packet;
  const std::uint32_t magic = reader.number(4);
  packet.sequence = reader.number(4);
  packet.is_fragment = magic == fragment_magic;
  if (magic != short_magic && magic != fragment_magic) return std::nullopt;
  if (packet.is_fragment) {
    packet.message_bytes = reader.number(4);
    packet.offset = reader.number(4);
    packet.number = static_cast<std::uint16_t>(reader.number(2));
    packet.fragments = static_cast<std::uint16_t>(reader.number(2));
  }
  if (packet.names_channel()) packet.channel = reader.channel();
  packet.data = reader.rest();
  if (!packet.is_fragment) packet.message_bytes = static_cast<std::uint32_t>(packet.data.size());
  if (reader.failed() || !is_consistent(packet)) return std::nullopt;
  return packet;
}

}  // namespace isthmus
