#include "server/wire/live/lcm_link.hpp"

#include <cctype>
#include <chrono>
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <span>
#include <stdexcept>

#include "server/wire/journal/event_log.hpp"
#include "server/wire/message/message.hpp"

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
std::string input_expression(const ChannelNames& configured) {
  std::string expression = "((?i:.+_(ROBOT|ODOMETRY|SCAN|SIGHTING)|ISTHMUS_(TAG|COMMAND|REQUEST|SIGNED))";
  for (const auto& [name, robot] : configured) {
    for (const std::string& channel : {robot.odometry, robot.scan, robot.sighting}) {
      if (!channel.empty()) expression += "|" + quoted(channel);
    }
  }
  return expression + ")";
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

/// For liblcm's subscription.
struct LcmSubscriber {
  Reception reception;

  void handle(const lcm::ReceiveBuffer* buffer, const std::string& name) noexcept {
    reception.take(buffer->recv_utime, name,
                   {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
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

void LcmLink::receive_into(Inbox& inbox, const ChannelNames& configured, Authenticator authenticator,
                           ReceptionWatch watch) {
  // Made in place: what others call by reference is not moved.
  subscriber_.reset(
      new LcmSubscriber{Reception(inbox, configured, std::move(authenticator), std::move(watch))});
  if (!lcm_) {
    thread_ = std::jthread([this](const std::stop_token& stop) { receive_log(stop); });
    return;
  }
  if (udp_) {
    thread_ = std::jthread([this](const std::stop_token& stop) { receive_udp(stop); });
    return;
  }
  lcm::Subscription* subscription =
      lcm_->subscribe(input_expression(configured), &LcmSubscriber::handle, subscriber_.get());
  if (!subscription) throw std::runtime_error("cannot subscribe to the input channels");
  subscription->setQueueCapacity(queue_messages);
  thread_ = std::jthread([this](const std::stop_token& stop) { receive_queue(stop); });
}

DropReason LcmLink::take(const std::string& channel, std::span<const std::uint8_t> bytes) {
  return subscriber_->reception.take(0, channel, bytes);  // the inbox's clock gives it its time
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
  Reassembly messages(subscriber_->reception.sink());
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
      if (!message || !subscriber_->reception.take_waiting(*message)) break;
    }
  } catch (const std::exception& error) {
    std::cerr << "isthmus-server: " << error.what() << "\n";
  }
  ended_ = true;
}

}  // namespace isthmus
