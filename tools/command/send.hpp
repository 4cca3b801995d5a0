#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "isthmus/answer_t.hpp"
#include "server/wire/message/server_configuration.hpp"
#include "tools/command/order.hpp"

namespace lcm {
class LCM;
}

namespace isthmus {

/// What an operator signs orders with.
struct OperatorKey {
  std::string name;
  AuthKey key{};
  std::string warning;  ///< about the file that they came from; empty: none
};

/// Reads a file of one line: the operator's name and the key in 64 hexadecimal digits. Throws
/// std::runtime_error naming the file where it holds something else or anybody may write it.
OperatorKey read_operator_key(const std::string& file);

/// What was heard after an order was sent.
struct OrderOutcome {
  std::optional<answer_t> answer;  ///< to this order
  bool any_server = false;         ///< some server sent something
};

/// Why no server would read an order; empty: it would.
std::string why_unreadable(const Order& order);

/// Publishes an order on its channel, in an envelope where there is a key, and waits so long for the
/// answer on ISTHMUS_ANSWER. Throws std::runtime_error where it is none that a server would read, or the
/// network does not take the message.
OrderOutcome send_order(lcm::LCM& lcm, const Order& order, const std::optional<OperatorKey>& key,
                        std::chrono::milliseconds wait);

}  // namespace isthmus
