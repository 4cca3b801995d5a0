#include "server/wire/lcm_link.hpp"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <span>
#include <stdexcept>

#include "server/wire/channel.hpp"
#include "server/wire/envelope.hpp"
#include "server/wire/event_log.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t receive_buffer_bytes = 4 * 1024 * 1024;
constexpr int queue_messages = 4000;

bool is_udp(const std::string& url) { return url.starts_with("udpm://"); }

/// The value of an option of the URL; empty where it is not given.
std::string url_option(const std::string& url, const std::string& key) {
  const std::size_t query = url.find('?');
  for (std::size_t at = query; at != std::string::npos; at = url.find('&', at + 1)) {
    if (url.compare(at + 1, key.size() + 1, key + "=") != 0) continue;
    const std::size_t from = at + key.size() + 2;
    return url.substr(from, url.find('&', from) - from);
  }
  return "";
}

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

std::string cannot_open(const std::string& url) {
  std::string reason = "cannot open LCM network " + url;
  if (is_udp(url)) {
    reason +=
        "\nIf this machine has no route for multicast, give it one:\n"
        "  ip link set lo up; ip route add 224.0.0.0/4 dev lo";
  }
  return reason;
}

}  // namespace

/// Copies messages into the inbox; for a network, called by liblcm in the receiving thread.
struct LcmHandler {
  Inbox& inbox;
  Configuration configuration;
  Authenticator authenticator;

  void handle(const lcm::ReceiveBuffer* buffer, const std::string& name) noexcept {
    // Nothing may escape into liblcm, whose next handle() would abort.
    try {
      const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
      if (name == signed_channel) {
        if (const std::optional<Message> message = opened(buffer->recv_utime, bytes)) put(*message);
        return;
      }
      const std::optional<Channel> channel = find_channel(configuration, name);
      if (!channel) return;
      if (authenticator.is_required()) {
        inbox.count_drop(channel->robot, "unsigned");
      } else {
        inbox.push(channel->robot, channel->input == Input::scan, buffer->recv_utime, name, bytes);
      }
    } catch (const std::exception& error) {
      std::cerr << "isthmus-server: a message was lost on receipt: " << error.what() << "\n";
    }
  }

  void put(const Message& message) {
    const std::optional<Channel> channel = find_channel(configuration, message.channel);
    if (!channel) return;
    inbox.push(channel->robot, channel->input == Input::scan, message.utime, message.channel, message.bytes,
               message.signature);
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

std::string complete_lcm_url(const std::string& url) {
  if (!is_udp(url) || !url_option(url, "recv_buf_size").empty()) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") +
         "recv_buf_size=" + std::to_string(receive_buffer_bytes);
}

std::vector<std::string> lcm_url_warnings(const std::string& url, std::int64_t kernel_buffer_bytes) {
  std::vector<std::string> warnings;
  if (!is_udp(url)) return warnings;
  if (const std::string ttl = url_option(url, "ttl"); !ttl.empty() && std::atoi(ttl.c_str()) != 0) {
    warnings.push_back(
        "ttl=" + ttl +
        ": messages leave this machine, and come in from others. LCM trusts every sender; use a "
        "network whose every member you trust, or give the robots keys ([auth] in the configuration).");
  }
  const std::int64_t asked = std::atoll(url_option(url, "recv_buf_size").c_str());
  if (kernel_buffer_bytes > 0 && kernel_buffer_bytes < asked) {
    warnings.push_back(
        "the kernel clips the receive buffer to " + std::to_string(kernel_buffer_bytes) + " of " +
        std::to_string(asked) +
        " bytes, so bursts of scans may be lost: sysctl -w net.core.rmem_max=" + std::to_string(asked));
  }
  return warnings;
}

std::string log_file_of(const std::string& url) {
  const std::string scheme = "file://";
  return url.starts_with(scheme) ? url.substr(scheme.size(), url.find('?') - scheme.size()) : "";
}

std::int64_t kernel_receive_buffer_bytes() {
  std::ifstream file("/proc/sys/net/core/rmem_max");
  std::int64_t bytes = 0;
  return file >> bytes ? bytes : 0;
}

LcmLink::LcmLink(const std::string& url, Log log) : log_(std::move(log)), log_file_(log_file_of(url)) {
  if (!log_file_.empty()) return;
  lcm_ = std::make_unique<lcm::LCM>(url);
  if (!lcm_->good()) throw std::runtime_error(cannot_open(url));
}

LcmLink::~LcmLink() { stop(); }

void LcmLink::receive_into(Inbox& inbox, const Configuration& configuration, Authenticator authenticator) {
  handler_ = std::make_unique<LcmHandler>(LcmHandler{inbox, configuration, std::move(authenticator)});
  if (!lcm_) {
    thread_ = std::jthread([this](const std::stop_token& stop) { receive_log(stop); });
    return;
  }
  lcm::Subscription* subscription =
      lcm_->subscribe(input_expression(configuration), &LcmHandler::handle, handler_.get());
  if (!subscription) throw std::runtime_error("cannot subscribe to the input channels");
  subscription->setQueueCapacity(queue_messages);
  thread_ = std::jthread([this](const std::stop_token& stop) { receive_network(stop); });
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

void LcmLink::receive_network(const std::stop_token& stop) {
  using namespace std::chrono_literals;
  while (!stop.stop_requested()) {
    const bool fails = lcm_->handleTimeout(100) < 0;
    note(receiving_fails_, fails, "receiving fails; trying on", "receiving again");
    if (fails) std::this_thread::sleep_for(100ms);  // a network may come back
  }
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
