#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "server/wire/file/file_bytes.hpp"
#include "server/wire/network/lcm_url.hpp"
#include "server/wire/network/reassembly.hpp"

namespace isthmus {

/// Receives LCM's UDP multicast: joins the group as liblcm does, beside other receivers on this machine. In
/// place of liblcm's own receiver, which a forged fragment makes write out of bounds. One thread.
class UdpReceiver {
 public:
  /// From here on the kernel keeps what comes. Throws std::runtime_error with the reason.
  explicit UdpReceiver(const UdpAddress& address);

  /// Waits at most `wait` for datagrams and hands them on, with the kernel's receive times; returns after
  /// some hundred of them at most. Returns 0 or errno.
  int receive(std::chrono::milliseconds wait, Reassembly& messages);

 private:
  int take_one(Reassembly& messages);

  FileHandle socket_;
  std::vector<std::uint8_t> datagram_;
};

}  // namespace isthmus
