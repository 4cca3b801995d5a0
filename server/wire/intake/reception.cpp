#include "server/wire/intake/reception.hpp"

#include <iostream>
#include <utility>

#include "server/wire/message/message.hpp"
#include "server/wire/trust/envelope.hpp"
#include "server/wire/trust/order_in.hpp"

namespace isthmus {
namespace {

/// Where servers tell how they are: this one, and whoever else is on the network.
constexpr std::string_view status_channel = "ISTHMUS_STATUS";

/// Inputs that only a robot that has introduced itself may send.
bool has_owner(Input input) {
  return input == Input::odometry || input == Input::scan || input == Input::sighting ||
         input == Input::initial_pose;
}

/// Of what a log or a network may say: not what a server writes into its own journal.
bool is_for_us(const std::optional<Channel>& channel) {
  return channel && channel->input != Input::configuration && channel->input != Input::tick;
}

}  // namespace

Reception::Reception(Inbox& inbox, ChannelNames configured, Authenticator authenticator, ReceptionWatch watch)
    : inbox_(inbox),
      configured_(std::move(configured)),
      authenticator_(std::move(authenticator)),
      watch_(std::move(watch)) {}

LcmSink Reception::sink() {
  return {[this](std::string_view channel) { return wants(std::string(channel)); },
          [this](std::int64_t utime, std::string_view channel, std::span<const std::uint8_t> bytes) {
            if (channel == status_channel)
              watch_.mistakes->heard_status(bytes);
            else
              take(utime, std::string(channel), bytes);
          },
          [this](std::string_view channel, DropReason reason) {
            if (channel == status_channel) return;  // none of ours
            const std::optional<Channel> found = find_channel(configured_, std::string(channel));
            inbox_.count_drop(found ? found->robot : "", reason);
          }};
}

bool Reception::wants(const std::string& channel) const {
  if (channel == status_channel) return watch_.mistakes != nullptr;
  if (is_request_channel(channel)) return watch_.questions != nullptr;
  return channel == signed_channel || is_for_us(find_channel(configured_, channel));
}

DropReason Reception::take(std::int64_t utime, const std::string& name,
                           std::span<const std::uint8_t> bytes) noexcept {
  // Nothing may escape into liblcm, whose next handle() would abort.
  try {
    const std::lock_guard lock(mutex_);
    const DropReason reason = let_in(utime, name, bytes);
    if (reason != DropReason::none) tell_refused(utime, name, bytes, reason);
    return reason;
  } catch (const std::exception& error) {
    std::cerr << "isthmus-server: a message was lost on receipt: " << error.what() << "\n";
    return DropReason::queue_full;
  }
}

DropReason Reception::let_in(std::int64_t utime, const std::string& name,
                             std::span<const std::uint8_t> bytes) {
  if (name == signed_channel) return let_in_envelope(utime, bytes);
  if (is_request_channel(name)) return ask(bytes);
  const std::optional<Channel> channel = find_channel(configured_, name);
  if (!channel) return DropReason::none;
  if (!authenticator_.is_required()) return push(*channel, utime, name, bytes);
  count_refused(channel->robot, DropReason::not_signed);
  return DropReason::not_signed;
}

DropReason Reception::let_in_envelope(std::int64_t utime, std::span<const std::uint8_t> bytes) {
  const Opened envelope = opened(utime, bytes);
  if (!envelope.message) return envelope.reason;
  const Message& message = *envelope.message;
  if (is_request_channel(message.channel)) {
    if (watch_.questions) watch_.questions->take(message.bytes, message.signature->sender);
  } else if (const std::optional<Channel> channel = find_channel(configured_, message.channel)) {
    return push(*channel, message.utime, message.channel, message.bytes, message.signature);
  }
  return DropReason::none;
}

/// A question that nobody signed.
DropReason Reception::ask(std::span<const std::uint8_t> bytes) {
  if (!watch_.questions) return DropReason::none;
  if (authenticator_.is_required()) {
    count_refused("", DropReason::not_signed);
    return DropReason::not_signed;
  }
  watch_.questions->take(bytes, "");
  return DropReason::none;
}

void Reception::tell_refused(std::int64_t utime, const std::string& channel,
                             std::span<const std::uint8_t> bytes, DropReason reason) const {
  if (watch_.questions)
    if (const std::optional<request_t> request = request_in(channel, bytes))
      return watch_.questions->refuse(*request, word(reason));
  if (!watch_.refused_order) return;
  if (const std::optional<command_t> order = order_in(channel, bytes))
    watch_.refused_order(*order, reason, utime);
}

/// Strangers are refused here, where they have cost nothing yet. What comes right behind a robot's first
/// introduction is let in: it need not wait for the engine. Nor must who introduced itself while the journal
/// was read still be a stranger afterwards, so that introductions count from the start.
DropReason Reception::push(const Channel& channel, std::int64_t utime, const std::string& name,
                           std::span<const std::uint8_t> bytes, const std::optional<Signature>& signature) {
  if (has_owner(channel.input) && inbox_.is_stranger(channel.robot)) {
    refuse_stranger(channel, bytes);
    return DropReason::unknown_robot;
  }
  const bool introduces = channel.input == Input::robot && !inbox_.is_reserved(channel.robot) &&
                          decode(configured_, name, bytes, utime).event;
  if (introduces) inbox_.introduce(channel.robot);
  inbox_.push(channel.robot, channel.input == Input::scan, utime, name, bytes, signature);
  return DropReason::none;
}

void Reception::refuse_stranger(const Channel& channel, std::span<const std::uint8_t> bytes) {
  inbox_.count_drop("(others)", DropReason::unknown_robot);
  if (watch_.mistakes) watch_.mistakes->note(channel, bytes, DropReason::unknown_robot, 0);
}

/// For its signature, or because it has none.
void Reception::count_refused(const std::string& robot, DropReason reason) {
  inbox_.count_drop(robot, reason);
  if (watch_.mistakes) watch_.mistakes->note_refused(robot, reason);
}

bool Reception::take_waiting(const Message& logged) {
  if (logged.channel == signed_channel) {
    const Opened envelope = [&] {
      const std::lock_guard lock(mutex_);
      return opened(logged.utime, logged.bytes);
    }();
    return !envelope.message || take_waiting(*envelope.message);
  }
  const std::optional<Channel> channel = find_channel(configured_, logged.channel);
  if (!is_for_us(channel)) return true;
  return inbox_.push_waiting(channel->robot, channel->input == Input::scan, logged.utime, logged.channel,
                             logged.bytes, logged.signature);
}

/// What an envelope holds; counts those that are refused.
Opened Reception::opened(std::int64_t utime, std::span<const std::uint8_t> bytes) {
  Opened envelope = authenticator_.open(configured_, utime, bytes);
  if (!envelope.message) count_refused(envelope.robot, envelope.reason);
  return envelope;
}

}  // namespace isthmus
