#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace isthmus {

/// An LCM URL as liblcm reads it, udpm://239.255.76.67:7667?ttl=0 or memq://. For UDP the large receive
/// buffer that scans need is asked for, unless the URL asks for another. A URL file:///path is a log or
/// journal, read from its beginning to its end as fast as the engine takes it, with the times of the log.
std::string complete_lcm_url(const std::string& url);

/// What the user should know of a URL: messages that leave the machine, a receive buffer that the kernel
/// clips to `kernel_buffer_bytes` (net.core.rmem_max).
std::vector<std::string> lcm_url_warnings(const std::string& completed_url, std::int64_t kernel_buffer_bytes);

/// The log that a file:// URL names; empty for other URLs.
std::string log_file_of(const std::string& url);

/// net.core.rmem_max; 0 where it cannot be read.
std::int64_t kernel_receive_buffer_bytes();

bool is_udp(const std::string& url);

/// Where a udpm:// URL receives.
struct UdpAddress {
  std::string group = "239.255.76.67";  ///< IPv4 multicast address, in any form that inet_aton takes
  std::uint16_t port = 7667;
  int receive_buffer_bytes = 0;  ///< 0: the kernel's own choice
};

/// Reads a udpm:// URL as liblcm 1.3.1 does, which takes a number in any of C's forms and ignores what
/// follows it; an option without a number counts as not given. Throws std::runtime_error where the address or
/// the port is none.
UdpAddress parse_udp_url(const std::string& url);

}  // namespace isthmus
