#include "server/wire/lcm_link.hpp"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <span>
#include <stdexcept>

#include "server/wire/channel.hpp"

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
  std::string expression = "((?i:.+_(ROBOT|ODOMETRY|SCAN|SIGHTING)|ISTHMUS_(TAG|COMMAND))";
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

/// Called by liblcm in the receiving thread.
struct LcmHandler {
  Inbox& inbox;
  Configuration configuration;
  bool can_wait = false;

  void handle(const lcm::ReceiveBuffer* buffer, const std::string& name) noexcept {
    // Nothing may escape into liblcm, whose next handle() would abort.
    try {
      const std::optional<Channel> channel = find_channel(configuration, name);
      if (!channel) return;
      const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
      const bool is_scan = channel->input == Input::scan;
      if (can_wait) {
        inbox.push_waiting(channel->robot, is_scan, buffer->recv_utime, name, bytes);
      } else {
        inbox.push(channel->robot, is_scan, buffer->recv_utime, name, bytes);
      }
    } catch (const std::exception& error) {
      std::cerr << "isthmus-server: a message was lost on receipt: " << error.what() << "\n";
    }
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
        "network whose every member you trust.");
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

LcmLink::LcmLink(const std::string& url)
    : is_file_(!log_file_of(url).empty()), lcm_(std::make_unique<lcm::LCM>(url)) {
  if (!lcm_->good()) throw std::runtime_error(cannot_open(url));
}

LcmLink::~LcmLink() { stop(); }

void LcmLink::receive_into(Inbox& inbox, const Configuration& configuration) {
  handler_ = std::make_unique<LcmHandler>(LcmHandler{inbox, configuration, is_file_});
  lcm::Subscription* subscription =
      lcm_->subscribe(input_expression(configuration), &LcmHandler::handle, handler_.get());
  if (!subscription) throw std::runtime_error("cannot subscribe to the input channels");
  subscription->setQueueCapacity(queue_messages);
  thread_ = std::jthread([this](const std::stop_token& stop) { receive_loop(stop); });
}

void LcmLink::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void LcmLink::publish(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
  if (is_file_) return;  // a file that is read cannot be written to
  if (lcm_->publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())) != 0) publish_failures_ += 1;
}

void LcmLink::receive_loop(const std::stop_token& stop) {
  using namespace std::chrono_literals;
  while (!stop.stop_requested()) {
    if (lcm_->handleTimeout(100) >= 0) continue;
    if (is_file_) break;
    std::this_thread::sleep_for(100ms);  // a network may come back
  }
  ended_ = is_file_ && !stop.stop_requested();
}

}  // namespace isthmus
