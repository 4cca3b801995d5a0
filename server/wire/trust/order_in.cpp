#include "server/wire/trust/order_in.hpp"

#include "server/wire/message/channel.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/trust/envelope.hpp"

namespace isthmus {

std::optional<command_t> order_in(const std::string& channel, std::span<const std::uint8_t> bytes) {
  if (channel == signed_channel) {
    Envelope envelope;
    if (read_envelope(bytes, envelope) != DropReason::none || envelope.channel == signed_channel)
      return std::nullopt;
    return order_in(envelope.channel, envelope.payload);
  }
  const std::optional<Channel> found = find_channel({}, channel);
  if (!found || found->input != Input::command) return std::nullopt;
  return read_order(bytes);
}

}  // namespace isthmus
