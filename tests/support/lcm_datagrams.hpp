#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/wire/file/file_bytes.hpp"

namespace isthmus {

using Bytes = std::vector<std::uint8_t>;

inline void append_number(Bytes& bytes, std::uint32_t value, int size) {
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

inline void append_channel(Bytes& bytes, const std::string& channel) {
  bytes.insert(bytes.end(), channel.begin(), channel.end());
  bytes.push_back(0);
}

/// LC02, as liblcm sends what fits into one datagram.
inline Bytes short_datagram(std::uint32_t sequence, const std::string& channel,
                            std::span<const std::uint8_t> data) {
  Bytes bytes;
  append_number(bytes, 0x4c433032, 4);
  append_number(bytes, sequence, 4);
  append_channel(bytes, channel);
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

/// The head and data of an LC03 fragment, right or wrong.
struct TestFragment {
  std::uint32_t sequence = 0;
  std::uint32_t message_bytes = 0;
  std::uint32_t offset = 0;
  std::uint16_t number = 0;
  std::uint16_t fragments = 1;
  std::string channel;  ///< of the first
  Bytes data;
};

inline Bytes fragment_datagram(const TestFragment& fragment) {
  Bytes bytes;
  append_number(bytes, 0x4c433033, 4);
  append_number(bytes, fragment.sequence, 4);
  append_number(bytes, fragment.message_bytes, 4);
  append_number(bytes, fragment.offset, 4);
  append_number(bytes, fragment.number, 2);
  append_number(bytes, fragment.fragments, 2);
  if (fragment.number == 0) append_channel(bytes, fragment.channel);
  bytes.insert(bytes.end(), fragment.data.begin(), fragment.data.end());
  return bytes;
}

/// A message cut into fragments of at most so many bytes, channel included.
inline std::vector<Bytes> fragment_datagrams(std::uint32_t sequence, const std::string& channel,
                                             std::span<const std::uint8_t> message,
                                             std::size_t fragment_bytes) {
  std::vector<TestFragment> fragments;
  for (std::size_t offset = 0; fragments.empty() || offset < message.size();) {
    const std::size_t room = fragment_bytes - (fragments.empty() ? channel.size() + 1 : 0);
    const auto part = message.subspan(offset, std::min(room, message.size() - offset));
    fragments.push_back({sequence,
                         static_cast<std::uint32_t>(message.size()),
                         static_cast<std::uint32_t>(offset),
                         static_cast<std::uint16_t>(fragments.size()),
                         0,
                         channel,
                         {part.begin(), part.end()}});
    offset += part.size();
  }
  std::vector<Bytes> datagrams;
  for (TestFragment& fragment : fragments) {
    fragment.fragments = static_cast<std::uint16_t>(fragments.size());
    datagrams.push_back(fragment_datagram(fragment));
  }
  return datagrams;
}

/// The two datagrams that make liblcm 1.3.1 write out of bounds: offset and length of the second add up to
/// 0x100 in 32 bits.
inline std::vector<Bytes> wrapped_offset_attack(const std::string& channel) {
  return {fragment_datagram({7, 1000, 0, 0, 3, channel, Bytes(100, 1)}),
          fragment_datagram({7, 1000, 0xfffff000, 1, 3, "", Bytes(0x1100, 2)})};
}

/// A network of this process' own on this machine: tests run at the same time as others.
inline std::uint16_t test_udp_port() { return static_cast<std::uint16_t>(20'000 + ::getpid() % 12'000); }
inline std::string test_udp_url() {
  return "udpm://239.255.76.67:" + std::to_string(test_udp_port()) + "?ttl=0&recv_buf_size=4194304";
}

/// Sends datagrams to that network as a sender of its own.
class DatagramSender {
 public:
  DatagramSender() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    const unsigned char ttl = 0;
    ::setsockopt(socket_.get(), IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
  }

  /// False where the network refuses it.
  bool send(const Bytes& datagram) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(test_udp_port());
    to.sin_addr.s_addr = inet_addr("239.255.76.67");
    return ::sendto(socket_.get(), datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&to),
                    sizeof to) == static_cast<ssize_t>(datagram.size());
  }

 private:
  FileHandle socket_;
};

}  // namespace isthmus
