#include "tools/command/heard_server.hpp"

#include <cstdint>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <span>

#include "isthmus/status_t.hpp"
#include "server/wire/message/byte_check.hpp"

namespace isthmus {

HeardServer::HeardServer(lcm::LCM& lcm)
    : link_(lcm.getUnderlyingLCM()),
      subscription_(lcm_subscribe(link_, "ISTHMUS_STATUS", &HeardServer::note, this)) {}

HeardServer::~HeardServer() { lcm_unsubscribe(link_, subscription_); }

// Looks at the type only: a message's counts are not to be trusted by a generated decoder.
void HeardServer::note(const lcm_recv_buf_t* buffer, const char*, void* self) noexcept {
  const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
  if (bytes.size() >= 8 && read_int64(bytes) == status_t::getHash())
    static_cast<HeardServer*>(self)->any_ = true;
}

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
