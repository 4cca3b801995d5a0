#include "tools/command/send.hpp"

#include <array>
#include <lcm/lcm-cpp.hpp>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "server/engine/input/robot_name.hpp"
#include "server/wire/file/text_file.hpp"
#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/message/reason_sentence.hpp"
#include "server/wire/trust/envelope.hpp"
#include "tools/command/heard_server.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int32_t max_text_bytes = 64;
constexpr std::array answer_members = {fixed(8),
                                       fixed(8),
                                       text(max_text_bytes),
                                       fixed(8),
                                       text(max_text_bytes),
                                       text(max_text_bytes),
                                       fixed(1),
                                       text(max_text_bytes)};

std::span<const std::uint8_t> bytes_of(const lcm_recv_buf_t* buffer) {
  return {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size};
}

/// Listens for the answer to an order, as long as it exists.
class Listener {
 public:
  Listener(lcm_t* link, std::int64_t order_utime) : link_(link), order_utime_(order_utime) {
    subscription_ = lcm_subscribe(link_, "ISTHMUS_ANSWER", note_answer, this);
  }
  ~Listener() { lcm_unsubscribe(link_, subscription_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  std::optional<answer_t> answer;

 private:
  static void note_answer(const lcm_recv_buf_t* buffer, const char*, void* self) noexcept {
    const auto bytes = bytes_of(buffer);
    if (check_bytes(answer_t::getHash(), answer_members, bytes) != DropReason::none) return;
    auto& listener = *static_cast<Listener*>(self);
    answer_t heard;
    const int size = static_cast<int>(bytes.size());
    if (heard.decode(bytes.data(), 0, size) != size || heard.order_utime != listener.order_utime_) return;
    listener.answer = std::move(heard);
  }

  lcm_t* link_;
  std::int64_t order_utime_;
  lcm_subscription_t* subscription_ = nullptr;
};

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

std::string why_unreadable(const Order& order) {
  // Any time will do: it is set when the order is sent.
  const Message message = std::visit([](const auto& body) { return encode(Event{1, body}); }, order);
  const Decoded decoded = decode({}, message.channel, message.bytes, 1);
  if (decoded.event) return "";
  const std::string_view reason = word(decoded.reason);
  return "no such order can be given: " + with_sentence(reason, sentence_of_order(reason));
}

OrderOutcome send_order(lcm::LCM& lcm, const Order& order, const std::optional<OperatorKey>& key,
                        std::chrono::milliseconds wait) {
  const std::int64_t utime = std::visit([](const auto& body) { return body.utime; }, order);
  const HeardServer server(lcm);
  Listener listener(lcm.getUnderlyingLCM(), utime);
  Message message = std::visit([&](const auto& body) { return encode(Event{utime, body}); }, order);
  // What no server would even read is not sent: nobody would answer.
  if (const std::string wrong = why_unreadable(order); !wrong.empty()) throw std::runtime_error(wrong);
  // The clock counts on from one order to the next, in whatever process.
  if (key) message = seal(key->key, key->name, utime, message);
  const auto size = static_cast<unsigned>(message.bytes.size());
  if (lcm.publish(message.channel, message.bytes.data(), size) != 0) {
    throw std::runtime_error("the network refused the message");
  }
  const Clock::time_point end = Clock::now() + wait;
  while (!listener.answer) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0 || lcm.handleTimeout(static_cast<int>(left)) <= 0) break;
  }
  const bool any_server = listener.answer || server.any();
  return {std::move(listener.answer), any_server};
}

}  // namespace isthmus
