#include "tools/command/order.hpp"

#include <limits>
#include <stdexcept>

#include "server/engine/input/robot_name.hpp"
#include "tools/text/numbers.hpp"

namespace isthmus {

std::int64_t parse_closure_id(const std::string& text) {
  const auto id = parse_integer(text);
  if (!id) throw std::runtime_error("not a closure's id: '" + text + "' (isthmus-inspect lists them)");
  if (*id < 0) throw std::runtime_error("a closure's id is not negative: " + text);
  if (*id > std::numeric_limits<std::int32_t>::max()) {
    throw std::runtime_error("too large for a closure's id: " + text);
  }
  return *id;
}

std::string parse_robot_name(const std::string& text) {
  std::string name = upper_case(text);
  if (!is_robot_name(name)) {
    throw std::runtime_error("not a robot's name: '" + text + "' (letters, digits, '_' and '-', at most 48)");
  }
  return name;
}

CommandEvent allow_order(const std::string& text) {
  CommandEvent order;
  order.verb = Verb::allow;
  if (parse_integer(text)) {
    order.closure = parse_closure_id(text);
  } else {
    order.robot = parse_robot_name(text);
  }
  return order;
}

std::string to_text(const CommandEvent& order) {
  std::string verb(word(order.verb));
  if (order.closure >= 0) return verb + " closure " + std::to_string(order.closure);
  if (!order.robot.empty()) return verb + " robot " + order.robot;
  return verb;
}

}  // namespace isthmus
