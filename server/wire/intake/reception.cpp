#include "server/wire/intake/reception.hpp"

#include <iostream>
#include <utility>

#include "server/wire/message/message.hpp"
#include "server/wire/trust/envelope.hpp"

namespace isthmus {
namespace {

/// Inputs that only a robot that has introduced itself may send.
bool has_owner(Input input) {
  return input == Input::odometry || input == Input::scan || input == Input::sighting;
}

/// Of what a log or a network may say: not what a server writes into its own journal.
bool is_for_us(const std::optional<Channel>& channel) {
  return channel && channel->input != Input::configuration && channel->input != Input::tick;
}

}  // namespace

Reception::Reception(Inbox& inbox, ChannelNames configured, Authenticator authenticator, Log log)
    : inbox_(inbox),
      configured_(std::move(configured)),
      authenticator_(std::move(authenticator)),
      log_(std::move(log)) {}

LcmSink Reception::sink() {
  return {[this](std::string_view channel) { return wants(std::string(channel)); },
          [this](std::int64_t utime, std::string_view channel, std::span<const std::uint8_t> bytes) {
            take(utime, std::string(channel), bytes);
          },
          [this](std::string_view channel, DropReason reason) {
            const std::optional<Channel> found = find_channel(configured_, std::string(channel));
            inbox_.count_drop(found ? found->robot : "", reason);
          }};
}

bool Reception::wants(const std::string& channel) const {
  return channel == signed_channel || is_for_us(find_channel(configured_, channel));
}

DropReason Reception::take(std::int64_t utime, const std::string& name,
                           std::span<const std::uint8_t> bytes) noexcept {
  // Nothing may escape into liblcm, whose next handle() would abort.
  try {
    const std::lock_guard lock(mutex_);
    return let_in(utime, name, bytes);
  } catch (const std::exception& error) {
    std::cerr << "isthmus-server: a message was lost on receipt: " << error.what() << "\n";
    return DropReason::queue_full;
  }
}

DropReason Reception::let_in(std::int64_t utime, const std::string& name,
                             std::span<const std::uint8_t> bytes) {
  if (name == signed_channel) {
    const Opened envelope = opened(utime, bytes);
    if (!envelope.message) return envelope.reason;
    const Message& message = *envelope.message;
    if (const std::optional<Channel> channel = find_channel(configured_, message.channel))
      push(*channel, message.utime, message.channel, message.bytes, message.signature);
    return DropReason::none;
  }
  const std::optional<Channel> channel = find_channel(configured_, name);
  if (!channel) return DropReason::none;
  if (!authenticator_.is_required()) {
    push(*channel, utime, name, bytes);
    return DropReason::none;
  }
  inbox_.count_drop(channel->robot, DropReason::not_signed);
  return DropReason::not_signed;
}

/// Strangers are refused here, where they have cost nothing yet. What comes right behind a robot's first
/// introduction is let in: it need not wait for the engine.
void Reception::push(const Channel& channel, std::int64_t utime, const std::string& name,
                     std::span<const std::uint8_t> bytes, const std::optional<Signature>& signature) {
  if (has_owner(channel.input) && inbox_.is_stranger(channel.robot)) return refuse_stranger(channel.robot);
  const bool introduces = channel.input == Input::robot && inbox_.is_stranger(channel.robot) &&
                          decode(configured_, name, bytes, utime).event;
  if (introduces) inbox_.introduce(channel.robot);
  inbox_.push(channel.robot, channel.input == Input::scan, utime, name, bytes, signature);
}

void Reception::refuse_stranger(const std::string& robot) {
  constexpr std::size_t max_told = 16;  // enough to see a robot that forgets to introduce itself
  inbox_.count_drop("(others)", DropReason::unknown_robot);
  if (!log_ || strangers_told_.size() >= max_told || !strangers_told_.insert(robot).second) return;
  log_(LogLevel::warning, "messages of a robot that has not introduced itself are refused",
       {{"robot", robot}});
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
  if (!envelope.message) inbox_.count_drop(envelope.robot, envelope.reason);
  return envelope;
}

}  // namespace isthmus
