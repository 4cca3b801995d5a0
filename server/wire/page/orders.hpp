#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "server/engine/input/drop_reason.hpp"
#include "server/engine/input/event.hpp"

namespace isthmus {

/// Gives the server a message as if the network had brought it; why it was refused, or none: it waits for its
/// turn.
using TakeMessage =
    std::function<DropReason(const std::string& channel, std::span<const std::uint8_t> bytes)>;

/// What a page may order.
using PageOrder = std::variant<CommandEvent, AnnotationEvent, InitialPoseEvent>;

/// An order that a request asks for, or what is wrong with it.
struct ParsedOrder {
  std::optional<PageOrder> order;
  std::string error;
};

/// {"verb": "withdraw", "closure": 3} or {"verb": "drop", "robot": "R2"}; withdraw, forbid, allow, drop or
/// refine. {"verb": "keep_out", "name": "stairs", "points": [[patch, x, y], ...]}; place (with "yaw"),
/// keep_out, speed (with "max_speed") or erase. {"verb": "initial_pose", "robot": "R2", "patch": 3,
/// "pose": [x, y, yaw], "sigma_m": 1, "sigma_rad": 0.5}. Points are in patches.
ParsedOrder parse_order(const std::string& json);

/// What became of an order.
struct OrderAnswer {
  bool answered = false;                 ///< false: the server had not taken it when time was over
  DropReason reason = DropReason::none;  ///< none: it is done
  std::string remark;                    ///< on one that is done, as of answer_t
};

/// Sends operators' orders the way of those from the network, and waits for what becomes of each. Any thread.
class Orders {
 public:
  explicit Orders(TakeMessage take, std::chrono::milliseconds wait = std::chrono::seconds(5));

  /// Unsigned; it is given a time stamp by which its answer is known.
  OrderAnswer send(PageOrder order);
  /// In its envelope (server/wire/trust/envelope.hpp), signed with an operator's key. What is no order is
  /// refused.
  OrderAnswer send_signed(std::span<const std::uint8_t> envelope);

  /// From the live server: what became of an order, whoever sent it, by its stamp.
  void answered(std::int64_t order_utime, DropReason reason, const std::string& remark = "");
  /// From now on nobody waits.
  void stop();

 private:
  OrderAnswer send(std::int64_t order_utime, const std::string& channel, std::span<const std::uint8_t> bytes);

  TakeMessage take_;
  std::chrono::milliseconds wait_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::int64_t last_utime_ = 0;
  bool stopped_ = false;
  std::multimap<std::int64_t, OrderAnswer> waiting_;  ///< by the order's stamp
};

}  // namespace isthmus
