#include "server/wire/trust/envelope.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "isthmus/signed_t.hpp"
#include "server/wire/file/digest.hpp"
#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

constexpr std::size_t mac_bytes = 32;
constexpr std::int32_t max_payload_bytes = 1024 * 1024;
constexpr std::array envelope_members = {text(64), text(64), fixed(8), array(1, max_payload_bytes),
                                         fixed(static_cast<std::int32_t>(mac_bytes))};

}  // namespace

Message seal(const AuthKey& key, const std::string& sender, std::int64_t counter, const Message& message) {
  signed_t envelope{};
  envelope.channel = message.channel;
  envelope.sender = sender;
  envelope.counter = counter;
  envelope.npayload = static_cast<std::int32_t>(message.bytes.size());
  envelope.payload = message.bytes;
  Message sealed{message.utime, signed_channel, encoded(envelope)};
  const std::size_t signed_bytes = sealed.bytes.size() - mac_bytes;
  const Digest mac = hmac_sha256(key, std::span(sealed.bytes).first(signed_bytes));
  std::copy(mac.begin(), mac.end(), sealed.bytes.begin() + static_cast<std::ptrdiff_t>(signed_bytes));
  return sealed;
}

DropReason read_envelope(std::span<const std::uint8_t> bytes, Envelope& envelope) {
  const DropReason reason = check_bytes(signed_t::getHash(), envelope_members, bytes);
  if (reason != DropReason::none) return reason;
  signed_t message;
  const int size = static_cast<int>(bytes.size());
  if (message.decode(bytes.data(), 0, size) != size) return DropReason::bad_length;
  envelope.channel = std::move(message.channel);
  envelope.sender = std::move(message.sender);
  envelope.counter = message.counter;
  envelope.payload = std::move(message.payload);
  return DropReason::none;
}

std::string key_fingerprint(const AuthKey& key) {
  constexpr std::string_view label = "isthmus key fingerprint";  // no envelope: those begin with their type
  const Digest mac = hmac_sha256(key, {reinterpret_cast<const std::uint8_t*>(label.data()), label.size()});
  std::string digits;
  for (const std::uint8_t byte : std::span(mac).first(6)) {
    digits += "0123456789abcdef"[byte >> 4];
    digits += "0123456789abcdef"[byte & 15];
  }
  return digits;
}

bool is_genuine(const AuthKey& key, std::span<const std::uint8_t> bytes) {
  const std::size_t signed_bytes = bytes.size() - mac_bytes;
  return begins_with(hmac_sha256(key, bytes.first(signed_bytes)), bytes.subspan(signed_bytes));
}

}  // namespace isthmus
