#include "server/wire/network/udp_receiver.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace isthmus {
namespace {

constexpr std::size_t longest_datagram_bytes = 65'536;  // a UDP length has 16 bits
constexpr int datagrams_at_once = 256;                  // then whoever stops the thread is heard

template <class Value>
void set_option(int socket, int level, int option, const Value& value, const char* what) {
  if (::setsockopt(socket, level, option, &value, sizeof value) != 0)
    throw std::runtime_error(std::string(what) + ": " + errno_text(errno));
}

FileHandle joined_socket(const UdpAddress& address) {
  FileHandle socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) throw std::runtime_error("cannot open a socket: " + errno_text(errno));
  set_option(socket.get(), SOL_SOCKET, SO_REUSEADDR, 1, "cannot share the port");
  set_option(socket.get(), SOL_SOCKET, SO_TIMESTAMP, 1, "cannot have receive times");
  if (address.receive_buffer_bytes > 0)
    set_option(socket.get(), SOL_SOCKET, SO_RCVBUF, address.receive_buffer_bytes,
               "cannot set the receive buffer");
  sockaddr_in local{};
  local.sin_family = AF_INET;
  local.sin_port = htons(address.port);
  local.sin_addr.s_addr = htonl(INADDR_ANY);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&local), sizeof local) != 0)
    throw std::runtime_error("cannot have port " + std::to_string(address.port) + ": " + errno_text(errno));
  ip_mreq membership{};
  if (::inet_aton(address.group.c_str(), &membership.imr_multiaddr) == 0)
    throw std::runtime_error("'" + address.group + "' is no IPv4 address");
  membership.imr_interface.s_addr = htonl(INADDR_ANY);
  set_option(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, membership, "cannot join the multicast group");
  return socket;
}

std::int64_t microseconds(const timeval& time) { return time.tv_sec * 1'000'000 + time.tv_usec; }

/// When the kernel received a datagram, Unix time.
std::int64_t receive_utime(msghdr& header) {
  timeval time{};
  for (cmsghdr* entry = CMSG_FIRSTHDR(&header); entry != nullptr; entry = CMSG_NXTHDR(&header, entry)) {
    if (entry->cmsg_level != SOL_SOCKET || entry->cmsg_type != SCM_TIMESTAMP) continue;
    std::memcpy(&time, CMSG_DATA(entry), sizeof time);
    return microseconds(time);
  }
  ::gettimeofday(&time, nullptr);
  return microseconds(time);
}

std::int64_t monotonic_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace

UdpReceiver::UdpReceiver(const UdpAddress& address)
    : socket_(joined_socket(address)), datagram_(longest_datagram_bytes) {}

int UdpReceiver::receive(std::chrono::milliseconds wait, Reassembly& messages) {
  pollfd waiting{socket_.get(), POLLIN, 0};
  const int ready = ::poll(&waiting, 1, static_cast<int>(wait.count()));
  if (ready < 0) return errno == EINTR ? 0 : errno;
  if (ready == 0) return 0;
  for (int i = 0; i < datagrams_at_once; ++i) {
    const int error = take_one(messages);
    if (error == EAGAIN || error == EWOULDBLOCK || error == EINTR) return 0;
    if (error != 0) return error;
  }
  return 0;
}

int UdpReceiver::take_one(Reassembly& messages) {
  sockaddr_in from{};
  alignas(cmsghdr) std::array<char, 64> control{};
  iovec bytes{datagram_.data(), datagram_.size()};
  msghdr header{};
  header.msg_name = &from;
  header.msg_namelen = sizeof from;
  header.msg_iov = &bytes;
  header.msg_iovlen = 1;
  header.msg_control = control.data();
  header.msg_controllen = control.size();
  const ssize_t size = ::recvmsg(socket_.get(), &header, MSG_DONTWAIT);
  if (size < 0) return errno;
  messages.take({ntohl(from.sin_addr.s_addr), ntohs(from.sin_port)},
                std::span(datagram_).first(static_cast<std::size_t>(size)), receive_utime(header),
                monotonic_us());
  return 0;
}

}  // namespace isthmus
