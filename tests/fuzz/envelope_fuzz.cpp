#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "server/wire/journal/signature.hpp"
#include "server/wire/trust/authenticator.hpp"
#include "server/wire/trust/envelope.hpp"

/// Input: one byte that says what it is, then the bytes of an envelope or of a journal's counters. Whatever
/// it is, an envelope that nobody with a key has sealed is refused with a reason; one that was sealed from
/// what was read is opened to the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isthmus;
  if (size == 0) return 0;
  const std::span bytes(data + 1, size - 1);
  if (data[0] % 2 == 1) {
    SignatureCounters counters;
    bool complete = false;
    raise_counters({0, "ISTHMUS_COUNTERS", {bytes.begin(), bytes.end()}}, counters, complete);
    return 0;
  }
  const AuthKey key = {1, 2, 3};
  Authentication keys;
  keys.robots["R1"] = key;
  Authenticator authenticator(keys);
  if (authenticator.open({}, 1, bytes).reason == DropReason::none) std::abort();
  Envelope envelope;
  if (read_envelope(bytes, envelope) != DropReason::none) return 0;
  const Message sealed =
      seal(key, envelope.sender, envelope.counter, {1, envelope.channel, envelope.payload});
  Envelope again;
  if (!is_genuine(key, sealed.bytes) || read_envelope(sealed.bytes, again) != DropReason::none) std::abort();
  if (again.payload != envelope.payload || again.channel != envelope.channel) std::abort();
  return 0;
}
