#pragma once

#include <lcm/lcm.h>

#include <string>

namespace lcm {
class LCM;
}

namespace isthmus {

/// Hears whether there is any server on a network, by ISTHMUS_STATUS, as long as it exists; while somebody
/// else handles messages of the network.
class HeardServer {
 public:
  explicit HeardServer(lcm::LCM& lcm);
  ~HeardServer();
  HeardServer(const HeardServer&) = delete;
  HeardServer& operator=(const HeardServer&) = delete;

  bool any() const { return any_; }

 private:
  static void note(const lcm_recv_buf_t* buffer, const char* channel, void* self) noexcept;

  lcm_t* link_;
  lcm_subscription_t* subscription_;
  bool any_ = false;
};

/// What is said where no answer came within a time.
std::string silence_text(double waited_s, bool any_server, const std::string& lcm_url);

}  // namespace isthmus
