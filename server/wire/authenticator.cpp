#include "server/wire/authenticator.hpp"

#include <utility>

#include "server/engine/robot_name.hpp"
#include "server/wire/channel.hpp"
#include "server/wire/envelope.hpp"

namespace isthmus {
namespace {

bool may_send(const Authentication& keys, const std::string& sender, const Channel& channel) {
  switch (channel.input) {
    case Input::tag:
      return true;
    case Input::command:
      return keys.operators.contains(sender);
    case Input::configuration:
    case Input::tick:
      return false;
    default:
      return channel.valid && channel.robot == sender;
  }
}

}  // namespace

Authenticator::Authenticator(Authentication keys, SignatureCounters counters)
    : keys_(std::move(keys)), counters_(std::move(counters)) {}

Opened Authenticator::open(const Configuration& configuration, std::int64_t utime,
                           std::span<const std::uint8_t> bytes) {
  Envelope envelope;
  if (!is_required()) return {{}, "", "no_keys"};
  if (std::string reason = read_envelope(bytes, envelope); !reason.empty())
    return {{}, "", std::move(reason)};
  const std::string sender = upper_case(envelope.sender);
  const AuthKey* key = key_of(sender);
  if (key == nullptr) return {{}, "", "unknown_sender"};
  const std::string robot = keys_.robots.contains(sender) ? sender : "";
  if (!is_genuine(*key, bytes)) return {{}, robot, "forged"};
  const std::optional<Channel> channel = find_channel(configuration, envelope.channel);
  if (!channel || !may_send(keys_, sender, *channel)) return {{}, robot, "foreign_channel"};
  const std::string stream = default_channel(channel->input, channel->robot);
  const auto [counter, is_first] = counters_.emplace(std::pair(sender, stream), envelope.counter);
  if (!is_first && envelope.counter <= counter->second) return {{}, robot, "replayed"};
  counter->second = envelope.counter;
  Message message{utime, std::move(envelope.channel), std::move(envelope.payload)};
  message.signature = Signature{sender, stream, envelope.counter};
  return {std::move(message), channel->robot, ""};
}

const AuthKey* Authenticator::key_of(const std::string& sender) const {
  for (const auto* group : {&keys_.robots, &keys_.operators}) {
    if (const auto found = group->find(sender); found != group->end()) return &found->second;
  }
  return nullptr;
}

}  // namespace isthmus
