#include "server/wire/network/lcm_url.hpp"

#include <arpa/inet.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace isthmus {
namespace {

constexpr std::int64_t receive_buffer_bytes = 4 * 1024 * 1024;
constexpr std::string_view udp_scheme = "udpm://";

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

/// The number that a text begins with, decimal, octal or hexadecimal; nothing where it begins with none.
std::optional<long> leading_number(const std::string& text) {
  char* end = nullptr;
  const long number = std::strtol(text.c_str(), &end, 0);
  return end == text.c_str() ? std::nullopt : std::optional(number);
}

std::uint16_t parse_port(const std::string& text) {
  const std::optional<long> port = leading_number(text);
  if (!port || *port < 0 || *port > std::numeric_limits<std::uint16_t>::max())
    throw std::runtime_error("'" + text + "' is no port");
  return static_cast<std::uint16_t>(*port);
}

}  // namespace

bool is_udp(const std::string& url) { return url.starts_with(udp_scheme); }

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

UdpAddress parse_udp_url(const std::string& url) {
  UdpAddress address;
  const std::string target = url.substr(udp_scheme.size(), url.find('?') - udp_scheme.size());
  const std::size_t colon = target.find(':');
  if (!target.empty()) address.group = target.substr(0, colon);
  if (colon != std::string::npos) address.port = parse_port(target.substr(colon + 1));
  in_addr group{};
  if (::inet_aton(address.group.c_str(), &group) == 0)
    throw std::runtime_error("'" + address.group + "' is no IPv4 address");
  const long buffer_bytes = leading_number(url_option(url, "recv_buf_size")).value_or(0);
  if (buffer_bytes > 0 && buffer_bytes <= std::numeric_limits<int>::max())
    address.receive_buffer_bytes = static_cast<int>(buffer_bytes);
  return address;
}

}  // namespace isthmus
