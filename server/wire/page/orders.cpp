#include "server/wire/page/orders.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/engine/input/robot_name.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/trust/envelope.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;

constexpr std::array verbs = {Verb::withdraw, Verb::forbid, Verb::allow, Verb::drop, Verb::refine};

std::optional<Verb> verb_of(const Json& json) {
  for (const Verb verb : verbs)
    if (json == std::string(word(verb))) return verb;
  return std::nullopt;
}

std::optional<std::int64_t> closure_of(const Json& json) {
  if (!json.is_number_integer()) return std::nullopt;
  const auto id = json.get<std::int64_t>();
  if (id < 0 || id > std::numeric_limits<std::int32_t>::max()) return std::nullopt;
  return id;
}

std::int64_t wall_clock_utime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace

ParsedOrder parse_order(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return {{}, "no JSON object"};
  const std::optional<Verb> verb = verb_of(json.value("verb", Json()));
  if (!verb) return {{}, "verb must be withdraw, forbid, allow, drop or refine"};
  CommandEvent order;
  order.verb = *verb;
  const bool wants_robot = order.verb == Verb::drop || (order.verb == Verb::allow && json.contains("robot"));
  if (wants_robot) {
    const Json robot = json.value("robot", Json());
    if (robot.is_string()) order.robot = upper_case(robot.get<std::string>());
    if (!is_robot_name(order.robot)) return {{}, "robot must be a robot's name"};
  } else if (order.verb != Verb::refine) {
    const std::optional<std::int64_t> closure = closure_of(json.value("closure", Json()));
    if (!closure) return {{}, "closure must be a closure's id"};
    order.closure = *closure;
  }
  return {order, ""};
}

Orders::Orders(TakeMessage take, std::chrono::milliseconds wait) : take_(std::move(take)), wait_(wait) {}

OrderAnswer Orders::send(CommandEvent order) {
  {
    const std::lock_guard lock(mutex_);
    last_utime_ = std::max(last_utime_ + 1, wall_clock_utime());
    order.utime = last_utime_;
  }
  const Message message = encode(Event{order.utime, order});
  return send(order, message.channel, message.bytes);
}

OrderAnswer Orders::send_signed(std::span<const std::uint8_t> bytes) {
  Envelope envelope;
  if (const DropReason reason = read_envelope(bytes, envelope); reason != DropReason::none)
    return {true, reason};
  const Decoded decoded = decode({}, envelope.channel, envelope.payload, 0);
  const auto* order = decoded.event ? std::get_if<CommandEvent>(&decoded.event->body) : nullptr;
  if (!order)
    return {true, decoded.reason == DropReason::none ? DropReason::foreign_channel : decoded.reason};
  return send(*order, signed_channel, bytes);
}

OrderAnswer Orders::send(const CommandEvent& order, const std::string& channel,
                         std::span<const std::uint8_t> bytes) {
  std::unique_lock lock(mutex_);
  const auto entry = waiting_.emplace(order.utime, std::nullopt);
  lock.unlock();
  const DropReason refused = take_(channel, bytes);
  lock.lock();
  if (refused == DropReason::none) changed_.wait_for(lock, wait_, [&] { return stopped_ || entry->second; });
  const std::optional<DropReason> reason = refused == DropReason::none ? entry->second : refused;
  waiting_.erase(entry);
  return {reason.has_value(), reason.value_or(DropReason::none)};
}

void Orders::answered(const CommandEvent& order, DropReason reason) {
  {
    const std::lock_guard lock(mutex_);
    const auto [begin, end] = waiting_.equal_range(order.utime);
    for (auto entry = begin; entry != end; ++entry) entry->second = reason;
  }
  changed_.notify_all();
}

void Orders::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

}  // namespace isthmus
