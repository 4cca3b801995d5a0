#include "server/wire/trust/authenticator.hpp"

#include <utility>

#include "server/engine/input/robot_name.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/trust/envelope.hpp"

namespace isthmus {
namespace {

bool may_send(const Authentication& keys, const std::string& sender, const Channel& channel) {
  switch (channel.input) {
    case Input::tag:
      return true;
    case Input::command:
    case Input::annotation:
      return keys.operators.contains(sender);
    case Input::configuration:
    case Input::tick:
      return false;
    case Input::initial_pose:
      return keys.operators.contains(sender) || (channel.valid && channel.robot == sender);
    default:
      return channel.valid && channel.robot == sender;
  }
}

}  // namespace

Authenticator::Authenticator(Authentication keys, SignatureCounters counters)
    : keys_(std::move(keys)), counters_(std::move(counters)) {
  for (const auto* group : {&keys_.robots, &keys_.operators}) {
    for (const auto& [sender, key] : *group) signers_[sender] = {key, sender + "@" + key_fingerprint(key)};
  }
}

Opened Authenticator::open(const ChannelNames& configured, std::int64_t utime,
                           std::span<const std::uint8_t> bytes) {
  Envelope envelope;
  if (!is_required()) return {{}, "", DropReason::no_keys};
  if (const DropReason reason = read_envelope(bytes, envelope); reason != DropReason::none)
    return {{}, "", reason};
  const std::string sender = upper_case(envelope.sender);
  const auto signer = signers_.find(sender);
  if (signer == signers_.end()) return {{}, "", DropReason::unknown_sender};
  const std::string robot = keys_.robots.contains(sender) ? sender : "";
  if (!is_genuine(signer->second.key, bytes)) return {{}, robot, DropReason::forged};
  const bool asks = is_request_channel(envelope.channel);
  const std::optional<Channel> channel = find_channel(configured, envelope.channel);
  if (!asks && (!channel || !may_send(keys_, sender, *channel)))
    return {{}, robot, DropReason::foreign_channel};
  const std::string stream = asks ? request_channel : default_channel(channel->input, channel->robot);
  if (!counts_on(sender, stream, signer->second, envelope.counter)) return {{}, robot, DropReason::replayed};
  Message message{utime, std::move(envelope.channel), std::move(envelope.payload)};
  message.signature = Signature{signer->second.name, stream, envelope.counter};
  return {std::move(message), asks ? robot : channel->robot};
}

/// Whether a counter is above all that this sender's key has signed on a channel so far; it is the last then.
bool Authenticator::counts_on(const std::string& sender, const std::string& stream, const Signer& signer,
                              std::int64_t counter) {
  // A counter without a key's fingerprint is of an earlier form of the journal: of whatever key.
  const auto of_any_key = counters_.find({sender, stream});
  if (of_any_key != counters_.end() && counter <= of_any_key->second) return false;
  const auto [last, is_first] = counters_.emplace(std::pair(signer.name, stream), counter);
  if (!is_first && counter <= last->second) return false;
  last->second = counter;
  return true;
}

}  // namespace isthmus
