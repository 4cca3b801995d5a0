#pragma once

#include <chrono>

#include "server/engine/event.hpp"

namespace lcm {
class LCM;
}

namespace isthmus {

/// Publishes an order on ISTHMUS_COMMAND, and waits for the next ISTHMUS_STATUS: whether one came in that
/// time, so that some server listens. Throws std::runtime_error where the network does not take the message.
bool send_order(lcm::LCM& lcm, const CommandEvent& order, std::chrono::milliseconds wait);

}  // namespace isthmus
