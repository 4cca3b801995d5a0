#include "server/client/ask.hpp"

#include <chrono>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <span>
#include <stdexcept>
#include <utility>

#include "server/client/poses.hpp"
#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/message/members.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/trust/envelope.hpp"

namespace isthmus {
namespace {

using members::integer;
using members::name;
using members::number;
using Clock = std::chrono::steady_clock;

constexpr std::int32_t max_ids = 10'000'000;  // beyond what a server sends

constexpr std::array frontier_members = {integer, members::pose_values, fixed(2 * 8), number, number, number};
constexpr std::array reply_members = {number,
                                      number,
                                      number,
                                      name,
                                      name,
                                      fixed(1),
                                      name,
                                      integer,
                                      name,
                                      fixed(1),
                                      number,
                                      integer,
                                      integer,
                                      number,
                                      list(members::path_pose, max_poses),
                                      fixed(3 * 8),
                                      fixed(9 * 8),
                                      number,
                                      array(4, max_ids),
                                      list(frontier_members, max_poses),
                                      array(4, max_ids)};

std::int64_t wall_clock_utime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

/// Hears the replies to one question, as long as it exists.
class Listener {
 public:
  Listener(lcm_t* link, const request_t& request) : link_(link), request_(request) {
    subscription_ = lcm_subscribe(link_, reply_channel, note, this);
    lcm_subscription_set_queue_capacity(subscription_, max_waiting);
  }
  ~Listener() { lcm_unsubscribe(link_, subscription_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// The next that was heard; nothing where there is none until a time. Other messages that come are handled.
  std::optional<reply_t> next(lcm::LCM& lcm, Clock::time_point end) {
    while (heard_.empty()) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
      if (left <= 0 || lcm.handleTimeout(static_cast<int>(left)) <= 0) return std::nullopt;
    }
    std::optional<reply_t> reply = std::move(heard_.front());
    heard_.pop_front();
    return reply;
  }

 private:
  static constexpr int max_waiting = 100;

  static void note(const lcm_recv_buf_t* buffer, const char*, void* self) noexcept {
    const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    if (check_bytes(reply_t::getHash(), reply_members, bytes) != DropReason::none) return;
    auto& listener = *static_cast<Listener*>(self);
    reply_t reply;
    const int size = static_cast<int>(bytes.size());
    if (reply.decode(bytes.data(), 0, size) != size) return;
    const request_t& request = listener.request_;
    if (reply.asker == request.asker && reply.request_id == request.id &&
        reply.request_utime == request.utime)
      listener.heard_.push_back(std::move(reply));
  }

  lcm_t* link_;
  const request_t& request_;
  lcm_subscription_t* subscription_ = nullptr;
  std::deque<reply_t> heard_;
};

void set_time(request_t& request) {
  request.utime = wall_clock_utime();
  if (request.id == 0) request.id = request.utime;
}

/// Publishes a question. The clock counts signatures on from one to the next, in whatever process.
void publish(lcm::LCM& lcm, const request_t& request, const std::optional<QuestionKey>& key) {
  Message message{request.utime, request_channel, encoded(request)};
  if (key) message = seal(key->key, key->name, request.utime, message);
  const auto size = static_cast<unsigned>(message.bytes.size());
  if (lcm.publish(message.channel, message.bytes.data(), size) != 0)
    throw std::runtime_error("the network refused the message");
}

Clock::time_point in_s(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

request_t question(const std::string& kind, const std::string& asker, const std::string& robot) {
  constexpr double timeout_s = 5, radius_m = 0.25, clearance_m = 0.1;
  request_t request{};
  request.asker = asker;
  request.kind = kind;
  request.timeout_s = timeout_s;
  request.robot = robot;
  request.start_patch = request.target_patch = request.target_barcode = -1;
  request.radius_m = radius_m;
  request.clearance_m = clearance_m;
  return request;
}

std::optional<reply_t> ask(lcm::LCM& lcm, request_t request, const std::optional<QuestionKey>& key) {
  set_time(request);
  Listener listener(lcm.getUnderlyingLCM(), request);
  publish(lcm, request, key);
  return listener.next(lcm, in_s(request.timeout_s));
}

bool follow(lcm::LCM& lcm, request_t request, const std::function<bool(const reply_t&)>& tell,
            const std::optional<QuestionKey>& key) {
  set_time(request);
  Listener listener(lcm.getUnderlyingLCM(), request);
  publish(lcm, request, key);
  const Clock::time_point end = in_s(request.follow_s + request.timeout_s);
  for (bool is_first = true;; is_first = false) {
    const auto reply = listener.next(lcm, is_first ? in_s(request.timeout_s) : end);
    if (!reply) return false;
    const bool goes_on = tell(*reply);
    if (!reply->followed) return true;
    if (goes_on) continue;
    request.follow_s = 0;  // the same id again: it is followed no more
    request.utime = wall_clock_utime();
    publish(lcm, request, key);
    return true;
  }
}

}  // namespace isthmus
