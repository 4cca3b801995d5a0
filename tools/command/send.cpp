#include "tools/command/send.hpp"

#include <lcm/lcm-cpp.hpp>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "isthmus/status_t.hpp"
#include "server/engine/input/robot_name.hpp"
#include "server/wire/file/text_file.hpp"
#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/trust/envelope.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

/// Looks at the type only: a message's counts are not to be trusted by a generated decoder.
void note_status(const lcm_recv_buf_t* buffer, const char*, void* heard) noexcept {
  const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
  if (bytes.size() >= 8 && read_int64(bytes) == status_t::getHash()) *static_cast<bool*>(heard) = true;
}

}  // namespace

OperatorKey read_operator_key(const std::string& file) {
  std::istringstream stream(read_text_file(file));
  std::string warning = check_key_file(file);
  std::string name, digits, more;
  if (!(stream >> name >> digits) || stream >> more)
    throw std::runtime_error(file + ": must hold the operator's name and key, and no more");
  const std::optional<AuthKey> key = parse_auth_key(digits);
  if (!key) throw std::runtime_error(file + ": the key must be 64 hexadecimal digits");
  return {upper_case(name), *key, std::move(warning)};
}

bool send_order(lcm::LCM& lcm, const CommandEvent& order, const std::optional<OperatorKey>& key,
                std::chrono::milliseconds wait) {
  bool heard = false;
  lcm_t* link = lcm.getUnderlyingLCM();
  lcm_subscription_t* subscription = lcm_subscribe(link, "ISTHMUS_STATUS", note_status, &heard);
  Message message = encode(Event{order.utime, order});
  // The clock counts on from one order to the next, in whatever process.
  if (key) message = seal(key->key, key->name, order.utime, message);
  const auto size = static_cast<unsigned>(message.bytes.size());
  if (lcm.publish(message.channel, message.bytes.data(), size) != 0) {
    throw std::runtime_error("the network refused the message");
  }
  const Clock::time_point end = Clock::now() + wait;
  while (!heard) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0 || lcm.handleTimeout(static_cast<int>(left)) <= 0) break;
  }
  lcm_unsubscribe(link, subscription);
  return heard;
}

}  // namespace isthmus
