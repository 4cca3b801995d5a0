#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/wire/message/message.hpp"

namespace isthmus {

/// The channel of all envelopes. They have one of their own, so that whoever listens on R1_SCAN meets nothing
/// but scans there, signed or played from a journal.
inline constexpr const char* signed_channel = "ISTHMUS_SIGNED";

/// A message in its envelope, for sending. `counter` must be above that of the sender's last message on the
/// channel: a clock in microseconds will do.
Message seal(const AuthKey& key, const std::string& sender, std::int64_t counter, const Message& message);

/// What an envelope says, not believed yet.
struct Envelope {
  std::string channel;
  std::string sender;
  std::int64_t counter = 0;
  std::vector<std::uint8_t> payload;
};

/// Returns the reason for refusal, as `check_bytes`; `none` where `envelope` was read.
DropReason read_envelope(std::span<const std::uint8_t> bytes, Envelope& envelope);

/// Whether the envelope's last 32 bytes are HMAC-SHA-256 (RFC 2104) of those before, with this key. The bytes
/// must be an envelope's.
bool is_genuine(const AuthKey& key, std::span<const std::uint8_t> bytes);

/// Tells one key from another, 12 characters, without telling the key.
std::string key_fingerprint(const AuthKey& key);

}  // namespace isthmus
