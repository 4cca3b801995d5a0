#include "server/wire/page/orders.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/engine/input/robot_name.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/limits.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/message/wall_clock.hpp"
#include "server/wire/trust/envelope.hpp"
#include "server/wire/trust/order_in.hpp"

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

constexpr const char* initial_pose_verb = "initial_pose";

std::optional<AnnotationKind> annotation_kind_of(const Json& json) {
  return json.is_string() ? value_of<AnnotationKind>(json.get<std::string>()) : std::nullopt;
}

/// Numbers of a list; nothing where it is another, or of another length.
std::optional<std::vector<double>> numbers_of(const Json& json, std::size_t count) {
  if (!json.is_array() || json.size() != count) return std::nullopt;
  std::vector<double> numbers;
  for (const Json& one : json) {
    if (!one.is_number()) return std::nullopt;
    numbers.push_back(one.get<double>());
  }
  return numbers;
}

/// A patch's id; none where it is no whole number that can be one.
PatchId patch_of(double number) {
  const bool fits = number >= 0 && number <= std::numeric_limits<std::int32_t>::max();
  return PatchId{fits ? static_cast<std::int32_t>(number) : -1};
}

ParsedOrder parse_annotation(const Json& json, AnnotationKind kind) {
  AnnotationEvent order;
  order.kind = kind;
  const Json name = json.value("name", Json()), replace = json.value("replace", Json(false));
  const Json speed = json.value("max_speed", Json(0)), yaw = json.value("yaw", Json(0));
  const Json points = json.value("points", Json::array());
  if (!name.is_string() || !replace.is_boolean() || !speed.is_number() || !yaw.is_number() ||
      !points.is_array() || points.size() > max_annotation_points)
    return {{},
            "name must be text, replace true or false, max_speed and yaw numbers, points at most " +
                std::to_string(max_annotation_points)};
  order.name = name.get<std::string>();
  order.replace = replace.get<bool>();
  order.max_speed_m_s = speed.get<double>();
  order.yaw_rad = yaw.get<double>();
  for (const Json& point : points) {
    const auto numbers = numbers_of(point, 3);
    if (!numbers) return {{}, "a point must be [patch, x, y]"};
    order.points.push_back({patch_of((*numbers)[0]), {(*numbers)[1], (*numbers)[2]}});
  }
  return {std::move(order), ""};
}

ParsedOrder parse_initial_pose(const Json& json) {
  InitialPoseEvent order;
  const Json robot = json.value("robot", Json());
  if (robot.is_string()) order.robot = upper_case(robot.get<std::string>());
  if (!is_robot_name(order.robot)) return {{}, "robot must be a robot's name"};
  const auto pose = numbers_of(json.value("pose", Json()), 3);
  const auto others = numbers_of(Json::array({json.value("patch", Json()), json.value("sigma_m", Json()),
                                              json.value("sigma_rad", Json())}),
                                 3);
  if (!pose || !others) return {{}, "pose must be [x, y, yaw], patch, sigma_m and sigma_rad numbers"};
  order.patch = patch_of((*others)[0]);
  order.pose = {(*pose)[0], (*pose)[1], (*pose)[2]};
  order.sigma_m = (*others)[1];
  order.sigma_rad = (*others)[2];
  return {std::move(order), ""};
}

}  // namespace

ParsedOrder parse_order(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return {{}, "no JSON object"};
  const Json named = json.value("verb", Json());
  if (const auto kind = annotation_kind_of(named)) return parse_annotation(json, *kind);
  if (named == initial_pose_verb) return parse_initial_pose(json);
  const std::optional<Verb> verb = verb_of(named);
  if (!verb)
    return {
        {},
        "verb must be withdraw, forbid, allow, drop, refine, place, keep_out, speed, erase or initial_pose"};
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

OrderAnswer Orders::send(PageOrder order) {
  std::int64_t utime = 0;
  {
    const std::lock_guard lock(mutex_);
    utime = last_utime_ = std::max(last_utime_ + 1, wall_clock_utime());
  }
  const Message message = std::visit(
      [utime](auto& body) {
        body.utime = utime;
        return encode(Event{utime, body});
      },
      order);
  if (const Decoded decoded = decode({}, message.channel, message.bytes, utime); !decoded.event)
    return {true, decoded.reason, ""};
  return send(utime, message.channel, message.bytes);
}

OrderAnswer Orders::send_signed(std::span<const std::uint8_t> bytes) {
  Envelope envelope;
  if (const DropReason reason = read_envelope(bytes, envelope); reason != DropReason::none)
    return {true, reason, ""};
  const Decoded decoded = decode({}, envelope.channel, envelope.payload, 0);
  const std::optional<command_t> order = order_in(envelope.channel, envelope.payload);
  if (!order || !decoded.event)
    return {true, decoded.reason == DropReason::none ? DropReason::foreign_channel : decoded.reason, ""};
  return send(order->utime, signed_channel, bytes);
}

OrderAnswer Orders::send(std::int64_t order_utime, const std::string& channel,
                         std::span<const std::uint8_t> bytes) {
  std::unique_lock lock(mutex_);
  const auto entry = waiting_.emplace(order_utime, OrderAnswer{});
  lock.unlock();
  const DropReason refused = take_(channel, bytes);
  lock.lock();
  if (refused == DropReason::none)
    changed_.wait_for(lock, wait_, [&] { return stopped_ || entry->second.answered; });
  OrderAnswer answer = refused == DropReason::none ? entry->second : OrderAnswer{true, refused, ""};
  waiting_.erase(entry);
  return answer;
}

void Orders::answered(std::int64_t order_utime, DropReason reason, const std::string& remark) {
  {
    const std::lock_guard lock(mutex_);
    const auto [begin, end] = waiting_.equal_range(order_utime);
    for (auto entry = begin; entry != end; ++entry) entry->second = OrderAnswer{true, reason, remark};
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
