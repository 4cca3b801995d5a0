#include "server/wire/lcm_link.hpp"

#include <chrono>
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <set>
#include <span>
#include <stdexcept>

#include "server/wire/channel.hpp"
#include "server/wire/envelope.hpp"
#include "server/wire/event_log.hpp"
#include "server/wire/message.hpp"

namespace isthmus {
namespace {

using namespace std::chrono_literals;

constexpr int queue_messages = 4000;

/// A channel's name as a regular expression that matches nothing else.
std::string quoted(const std::string& channel) {
  std::string expression;
  for (const char c : channel) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') expression += '\\';
    expression += c;
  }
  return expression;
}

/// All inputs in one subscription, or a message on a channel that two of them match would come twice. liblcm
/// puts the anchors around it.
std::string input_expression(const Configuration& configuration) {
  std::string expression = "((?i:.+_(ROBOT|ODOMETRY|SCAN|SIGHTING)|ISTHMUS_(TAG|COMMAND|SIGNED))";
  for (const auto& [name, robot] : configuration.robots) {
    for (const std::string& channel : {robot.odometry_channel, robot.scan_channel, robot.sighting_channel}) {
      if (!channel.empty()) expression += "|" + quoted(channel);
    }
  }
  return expression + ")";
}

/// Inputs that only a robot that has introduced itself may send.
bool has_owner(Input input) {
  return input == Input::odometry || input == Input::scan || input == Input::sighting;
}

std::string cannot_open(const std::string& url, const std::string& why = "") {
  std::string reason = "cannot open LCM network " + url + (why.empty() ? "" : ": " + why);
  if (is_udp(url)) {
    reason +=
        "\nIf this machine has no route for multicast, give it one:\n"
        "  ip link set lo up; ip route add 224.0.0.0/4 dev lo";
  }
  return reason;
}

}  // namespace

/// Copies messages into the inbox; for a network, called in the receiving thread.
struct LcmHandler {
  Inbox& inbox;
  Configuration configuration;
  Authenticator authenticator;
  Log log;
  std::set<std::string> strangers_told = {};

  /// For liblcm's subscription.
  void handle(const lcm::ReceiveBuffer* buffer, const std::string& name) noexcept {
    take(buffer->recv_utime, name, {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
  }

  /// For the receiver of UDP.
  LcmSink sink() {
    return {[this](std::string_view channel) { return wants(std::string(channel)); },
            [this](std::int64_t utime, std::string_view channel, std::span<const std::uint8_t> bytes) {
              take(utime, std::string(channel), bytes);
            },
            [this](std::string_view channel, std::string_view reason) {
              const std::optional<Channel> found = find_channel(configuration, std::string(channel));
              inbox.count_drop(found ? found->robot : "", std::string(reason));
            }};
  }

  bool wants(const std::string& name) const {
    if (name == signed_channel) return true;
    const std::optional<Channel> channel = find_channel(configuration, name);
    return channel && channel->input != Input::configuration && channel->input != Input::tick;
  }

  void take(std::int64_t utime, const std::string& name, std::span<const std::uint8_t> bytes) noexcept {
    // Nothing may escape into liblcm, whose next handle() would abort.
    try {
      if (name == signed_channel) {
        if (const std::optional<Message> message = opened(utime, bytes)) put(*message);
        return;
      }
      const std::optional<Channel> channel = find_channel(configuration, name);
      if (!channel) return;
      if (authenticator.is_required()) {
        inbox.count_drop(channel->robot, "unsigned");
      } else {
        push(*channel, utime, name, bytes);
      }
    } catch (const std::exception& error) {
      std::cerr << "isthmus-server: a message was lost on receipt: " << error.what() << "\n";
    }
  }

  void put(const Message& message) {
    const std::optional<Channel> channel = find_channel(configuration, message.channel);
    if (!channel) return;
    push(*channel, message.utime, message.channel, message.bytes, message.signature);
  }

  /// Strangers are refused here, where they have cost nothing yet. What comes right behind a robot's first
  /// introduction is let in: it need not wait for the engine.
  void push(const Channel& channel, std::int64_t utime, const std::string& name,
            std::span<const std::uint8_t> bytes, const std::optional<Signature>& signature = std::nullopt) {
    if (has_owner(channel.input) && inbox.is_stranger(channel.robot)) return refuse_stranger(channel.robot);
    const bool introduces = channel.input == Input::robot && inbox.is_stranger(channel.robot) &&
                            decode(configuration, name, bytes, utime).event;
    if (introduces) inbox.introduce(channel.robot);
    inbox.push(channel.robot, channel.input == Input::scan, utime, name, bytes, signature);
  }

  void refuse_stranger(const std::string& robot) {
    constexpr std::size_t most_told = 16;  // enough to see a robot that forgets to introduce itself
    inbox.count_drop("(others)", "unknown_robot");
    if (!log || strangers_told.size() >= most_told || !strangers_told.insert(robot).second) return;
    log(LogLevel::warning, "messages of a robot that has not introduced itself are refused",
        {{"robot", robot}});
  }

  /// False once the inbox is closed.
  bool put_waiting(const Message& logged) {
    if (logged.channel == signed_channel) {
      const std::optional<Message> message = opened(logged.utime, logged.bytes);
      return !message || put_waiting(*message);
    }
    const std::optional<Channel> channel = find_channel(configuration, logged.channel);
    if (!channel || channel->input == Input::configuration || channel->input == Input::tick) return true;
    return inbox.push_waiting(channel->robot, channel->input == Input::scan, logged.utime, logged.channel,
                              logged.bytes, logged.signature);
  }

  /// What an envelope holds; counts those that are refused.
  std::optional<Message> opened(std::int64_t utime, std::span<const std::uint8_t> bytes) {
    Opened envelope = authenticator.open(configuration, utime, bytes);
    if (!envelope.message) inbox.count_drop(envelope.robot, envelope.reason);
    return std::move(envelope.message);
  }
};

LcmLink::LcmLink(const std::string& url, Log log) : log_(std::move(log)), log_file_(log_file_of(url)) {
  if (!log_file_.empty()) return;
  lcm_ = std::make_unique<lcm::LCM>(url);
  if (!lcm_->good()) throw std::runtime_error(cannot_open(url));
  if (!is_udp(url)) return;
  try {
    udp_ = std::make_unique<UdpReceiver>(parse_udp_url(url));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(cannot_open(url, error.what()));
  }
}

LcmLink::~LcmLink() { stop(); }

void LcmLink::receive_into(Inbox& inbox, const Configuration& configuration, Authenticator authenticator) {
  handler_ = std::make_unique<LcmHandler>(LcmHandler{inbox, configuration, std::move(authenticator), log_});
  if (!lcm_) {
    thread_ = std::jthread([this](const std::stop_token& stop) { receive_log(stop); });
    return;
  }
  if (udp_) {
    thread_ = std::jthread([this](const std::stop_token& stop) { receive_udp(stop); });
    return;
  }
  lcm::Subscription* subscription =
      lcm_->subscribe(input_expression(configuration), &LcmHandler::handle, handler_.get());
  if (!subscription) throw std::runtime_error("cannot subscribe to the input channels");
  subscription->setQueueCapacity(queue_messages);
  thread_ = std::jthread([this](const std::stop_token& stop) { receive_queue(stop); });
}

void LcmLink::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void LcmLink::publish(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
  if (!lcm_) return;
  const bool fails = lcm_->publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())) != 0;
  if (fails) publish_failures_ += 1;
  note(publishing_fails_, fails, "the network refuses messages; trying on with each",
       "the network takes messages again");
}

/// Logs that something begins or ceases to fail.
void LcmLink::note(std::atomic<bool>& failing, bool fails, const char* begins, const char* ends) const {
  if (failing.exchange(fails) == fails || !log_) return;
  log_(LogLevel::warning, fails ? begins : ends, {{"publish_failures", std::to_string(publish_failures_)}});
}

void LcmLink::receive_udp(const std::stop_token& stop) {
  Reassembly messages(handler_->sink());
  while (!stop.stop_requested()) note_receiving(udp_->receive(100ms, messages) != 0);
}

void LcmLink::receive_queue(const std::stop_token& stop) {
  while (!stop.stop_requested()) note_receiving(lcm_->handleTimeout(100) < 0);
}

void LcmLink::note_receiving(bool fails) {
  note(receiving_fails_, fails, "receiving fails; trying on", "receiving again");
  if (fails) std::this_thread::sleep_for(100ms);  // a network may come back
}

void LcmLink::receive_log(const std::stop_token& stop) {
  try {
    EventLogReader reader(log_file_);
    while (!stop.stop_requested()) {
      const std::optional<Message> message = reader.next();
      if (!message || !handler_->put_waiting(*message)) break;
    }
  } catch (const std::exception& error) {
    std::cerr << "isthmus-server: " << error.what() << "\n";
  }
  ended_ = true;
}

}  // namespace isthmus
