#include "tools/command/heard_server.hpp"

#include <cstdint>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <span>

#include "isthmus/status_t.hpp"
#include "server/wire/message/byte_check.hpp"

namespace isthmus {

struct HeardServer::Subscription {
  explicit Subscription(lcm_t* its_link)
      : link(its_link), handle(lcm_subscribe(link, "ISTHMUS_STATUS", &Subscription::note, this)) {}
  ~Subscription() { lcm_unsubscribe(link, handle); }
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;

  // Looks at the type only: a message's counts are not to be trusted by a generated decoder.
  static void note(const lcm_recv_buf_t* buffer, const char*, void* self) noexcept {
    const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    if (bytes.size() >= 8 && read_int64(bytes) == status_t::getHash())
      static_cast<Subscription*>(self)->any = true;
  }

  lcm_t* link;
  lcm_subscription_t* handle;
  bool any = false;
};

HeardServer::HeardServer(lcm::LCM& lcm)
    : subscription_(std::make_unique<Subscription>(lcm.getUnderlyingLCM())) {}

HeardServer::~HeardServer() = default;

bool HeardServer::any() const { return subscription_->any; }

std::string silence_text(double waited_s, bool any_server, const std::string& lcm_url) {
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%g", waited_s);
  return "no answer within " + std::string(seconds) + " s: " +
         (any_server ? "a server runs on " + lcm_url +
                           ", but has not answered in time: it is busy, or of an earlier version"
                     : "either no server runs on " + lcm_url + ", or it is too busy to answer in that time") +
         " (--wait gives it longer)";
}

}  // namespace isthmus
