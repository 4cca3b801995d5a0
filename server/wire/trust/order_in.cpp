#include "server/wire/trust/order_in.hpp"

#include "server/wire/message/channel.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/trust/envelope.hpp"

namespace isthmus {
namespace {

command_t said(std::int64_t utime, const std::string& verb, const std::string& about) {
  command_t order{};
  order.utime = utime;
  order.verb = verb;
  order.closure = -1;
  order.robot = about;
  return order;
}

}  // namespace

std::optional<command_t> order_in(const std::string& channel, std::span<const std::uint8_t> bytes) {
  if (channel == signed_channel) {
    Envelope envelope;
    if (read_envelope(bytes, envelope) != DropReason::none || envelope.channel == signed_channel)
      return std::nullopt;
    return order_in(envelope.channel, envelope.payload);
  }
  const std::optional<Channel> found = find_channel({}, channel);
  if (!found) return std::nullopt;
  switch (found->input) {
    case Input::command:
      return read_order(bytes);
    case Input::annotation:
      if (const auto annotation = read_annotation(bytes))
        return said(annotation->utime, annotation->kind, annotation->name);
      return std::nullopt;
    case Input::initial_pose:
      if (const auto pose = read_initial_pose(bytes)) return said(pose->utime, "initial_pose", found->robot);
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

}  // namespace isthmus
