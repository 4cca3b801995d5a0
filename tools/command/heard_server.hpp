#pragma once

#include <memory>
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

  bool any() const;

 private:
  struct Subscription;
  std::unique_ptr<Subscription> subscription_;
};

/// What is said where no answer came within a time.
std::string silence_text(double waited_s, bool any_server, const std::string& lcm_url);

}  // namespace isthmus
