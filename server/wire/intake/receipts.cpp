#include "server/wire/intake/receipts.hpp"

#include "server/engine/input/robot_name.hpp"
#include "server/wire/intake/inbox.hpp"
#include "server/wire/message/byte_check.hpp"

namespace isthmus {
namespace {

/// What a robot publishes: itself, odometry, scans, sightings.
constexpr std::size_t channels_per_sender = 4;
constexpr std::size_t max_strangers = channels_per_sender * InboxLimits{}.senders;

/// All inputs begin with their fingerprint and their stamp.
std::int64_t stamp_of(const Message& message) {
  const std::span<const std::uint8_t> bytes = message.bytes;
  return bytes.size() >= 16 ? read_int64(bytes.subspan(8)) : 0;
}

}  // namespace

void Receipts::add(const Message& message, bool known) {
  if (!known && strangers_ >= max_strangers) forget_strangers();
  const auto [found, is_new] = channels_.try_emplace(upper_case(message.channel));
  Channel& channel = found->second;
  if (is_new) strangers_ += 1;
  if (known && !channel.known) {
    channel.known = true;
    strangers_ -= 1;
  }
  channel.messages += 1;
  channel.newest_utime = stamp_of(message);
}

void Receipts::forget_strangers() {
  std::erase_if(channels_, [](const auto& entry) { return !entry.second.known; });
  strangers_ = 0;
}

received_t Receipts::message(std::int64_t utime, std::int64_t since_utime) const {
  received_t message{};
  message.utime = utime;
  message.since_utime = since_utime;
  for (const auto& [name, channel] : channels_) {
    received_channel_t one{};
    one.channel = name;
    one.messages = channel.messages;
    one.newest_utime = channel.newest_utime;
    message.channels.push_back(std::move(one));
  }
  message.nchannels = static_cast<std::int32_t>(message.channels.size());
  return message;
}

}  // namespace isthmus
