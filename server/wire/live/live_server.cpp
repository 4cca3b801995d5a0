#include "server/wire/live/live_server.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "server/wire/journal/drop_record.hpp"
#include "server/wire/message/answer_remark.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/trust/order_in.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

/// Configurations and ticks are the server's own entries in its journal: nobody may send them.
bool is_own(const Event& event) {
  return std::holds_alternative<ConfigurationEvent>(event.body) ||
         std::holds_alternative<TickEvent>(event.body);
}

bool asks_for_map(const Event& event) {
  const auto* command = std::get_if<CommandEvent>(&event.body);
  return command && command->verb == Verb::send_map;
}

}  // namespace

LiveServer::~LiveServer() { inbox_.keep_in(nullptr); }

void LiveServer::run() {
  if (recovery_ && recovery_->has_events()) recover();
  recovery_.reset();
  refuse_strangers();
  keep_snapshots();
  while (!inbox_.finished() && !is_past(handling_share)) {
    if (std::optional<Message> message = inbox_.pop(options_.tick_interval)) {
      handle(std::move(*message));
    } else {
      if (journal_) journal_->write_waiting();
    }
    tick_if_due();  // messages that are refused are none of the engine's, however many
    count_inbox_drops();
    record_drops_if_due();
    publish_status_if_due();
  }
  count_left_over();
  end();
}

/// From now on it is known who is on the map.
void LiveServer::refuse_strangers() {
  for (const auto& [name, robot] : map_.estimator().configuration().robots) inbox_.reserve(name);
  inbox_.refuse_strangers();
}

void LiveServer::handle(Message message) {
  message.utime = std::max(message.utime, map_.last_utime);
  const Decoded decoded = decode(map_.channels, message.channel, message.bytes, message.utime);
  const DropReason reason = hand_on(message, decoded);
  tell_sender(message, decoded, reason);
  note_mistakes(message, reason);
}

/// To the journal and the engine. Returns why it was refused.
DropReason LiveServer::hand_on(const Message& message, const Decoded& decoded) {
  Dropped one{1, {}};
  if (message.received >= 0) one.received.push_back(message.received);
  const auto refuse = [&](DropReason reason) {
    drop(decoded.robot, reason, one);
    return reason;
  };
  if (!decoded.ours) {
    drop("", DropReason::bad_channel, {0, one.received});  // not counted
    return DropReason::bad_channel;
  }
  if (!decoded.event) return refuse(decoded.reason);
  const Event& event = *decoded.event;
  if (is_own(event)) return refuse(DropReason::bad_channel);
  if (const DropReason reason = refusal(event); reason != DropReason::none) return refuse(reason);
  map_.last_utime = message.utime;
  map_.monitor.heard(decoded.robot, message.utime);
  if (!journal(message)) return refuse(DropReason::journal_full);
  const DropReason reason = take(event);
  reserve_queue(event);
  if (asks_for_map(event)) map_publisher_->request_whole();
  return reason;
}

/// Why the map does not take an event, if so. What is refused is not journalled.
DropReason LiveServer::refusal(const Event& event) {
  return map_.estimator().is_stranger(event) ? DropReason::unknown_robot : admission_.admit(event);
}

DropReason LiveServer::take(const Event& event) {
  const Clock::time_point start = Clock::now();
  const Outcome outcome = handle_guarded(guard_.get(), journal_ ? journal_->last_sequence() : -1,
                                         map_.estimator(), event, options_.before_event);
  last_event_ = Clock::now();
  latency_.add(seconds_of(last_event_ - start));
  if (options_.viewers.event) options_.viewers.event(event);
  if (const auto* robot = std::get_if<RobotEvent>(&event.body); robot && goals_)
    goals_->note_radius(robot->robot, robot->footprint_radius_m);
  publish_poses(outcome);
  return outcome.drop_reason;
}

/// False: the engine must not have the event, or its map would be another than a replay's.
bool LiveServer::journal(const Message& message) {
  if (!journal_) return true;
  if (!journal_->append(message)) return false;
  if (settlement_) settlement_->journalled(message);
  return true;
}

/// Of an order.
void LiveServer::tell_sender(const Message& message, const Decoded& decoded, DropReason reason) const {
  if (!decoded.ours) return;
  const std::optional<command_t> said = order_in(message.channel, message.bytes);
  if (!said) return;
  const std::string remark = reason == DropReason::none ? remark_on(decoded) : "";
  if (options_.viewers.order) options_.viewers.order(said->utime, reason, remark);
  answers_.tell(*said, message.signature, reason, remark, message.utime);
}

/// Of an order that is done: whether it is about a closure that nobody has proposed.
std::string LiveServer::remark_on(const Decoded& decoded) const {
  const auto* order = decoded.event ? std::get_if<CommandEvent>(&decoded.event->body) : nullptr;
  if (order == nullptr || order->verb != Verb::forbid) return "";
  const auto is_it = [&](const ClosureRecord& closure) { return closure.id.value == order->closure; };
  return std::ranges::any_of(map_.estimator().copy().closures, is_it) ? "" : not_proposed_yet;
}

/// Robots that the map knows; admission bounds their number.
void LiveServer::reserve_queue(const Event& event) {
  if (const auto* robot = std::get_if<RobotEvent>(&event.body)) inbox_.reserve(robot->robot);
}

void LiveServer::publish_poses(const Outcome& outcome) {
  for (const RobotPose& pose : outcome.poses) {
    map_.monitor.answered(pose);
    if (!map_.features) show(pose);  // what is shown, asked and explored is patches
    publish_(pose.robot + "_POSE", encoded(pose_message(pose)));
  }
}

void LiveServer::show(const RobotPose& pose) {
  if (options_.viewers.pose) options_.viewers.pose(pose);
  if (options_.questions) options_.questions->note(pose);
  if (goals_) goals_->note(pose);
}

void LiveServer::tick_if_due() {
  if (!options_.clock || Clock::now() - last_event_ < options_.tick_interval) return;
  if (!map_.estimator().has_queued_work()) return;
  map_.last_utime = std::max(map_.last_utime, options_.clock->now());
  const Event tick{map_.last_utime, TickEvent{}};
  if (journal(encode(tick))) take(tick);
}

void LiveServer::count_inbox_drops() {
  for (const auto& [robot, reasons] : inbox_.take_drops()) {
    for (const auto& [reason, dropped] : reasons) drop(robot, reason, dropped);
  }
}

void LiveServer::drop(const std::string& robot, DropReason reason, const Dropped& dropped) {
  count_drops(map_.estimator(), {{robot, {{reason, dropped}}}});
  if (settlement_) settlement_->dropped(robot, reason, dropped);
}

void LiveServer::say(LogLevel level, std::string_view message, const LogFields& fields) const {
  if (options_.log) options_.log(level, message, fields);
}

}  // namespace isthmus
