#include "tools/command/order.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "server/engine/annotations/annotations.hpp"
#include "server/engine/input/robot_name.hpp"
#include "tools/text/numbers.hpp"

namespace isthmus {
namespace {

/// Numbers with a comma between two; none where one is no finite number.
std::vector<double> parse_numbers(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (std::string one; std::getline(stream, one, ',');) {
    const std::optional<double> number = parse_double(one);
    if (!number || !std::isfinite(*number)) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace

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

std::vector<Eigen::Vector2d> parse_points(const std::string& text) {
  std::vector<Eigen::Vector2d> points;
  std::istringstream stream(text);
  for (std::string one; stream >> one;) {
    const std::vector<double> numbers = parse_numbers(one);
    if (numbers.size() != 2) throw std::runtime_error("not a point: '" + one + "' (x,y in metres)");
    points.emplace_back(numbers[0], numbers[1]);
  }
  return points;
}

Pose parse_pose(const std::string& text) {
  const std::vector<double> numbers = parse_numbers(text);
  if (numbers.size() != 2 && numbers.size() != 3)
    throw std::runtime_error("not a pose: '" + text + "' (x,y in metres, or x,y,yaw with degrees)");
  return {numbers[0], numbers[1], numbers.size() == 3 ? numbers[2] * std::numbers::pi / 180 : 0};
}

std::string parse_annotation_name(const std::string& text) {
  if (!is_annotation_name(text))
    throw std::runtime_error("not a name: '" + text + "' (1 to 48 letters, digits, ' ', '.', '_' and '-')");
  return text;
}

std::string to_text(const Order& order) {
  if (const auto* annotation = std::get_if<AnnotationEvent>(&order))
    return std::string(word(annotation->kind)) + " " + annotation->name;
  if (const auto* pose = std::get_if<InitialPoseEvent>(&order)) return "initial_pose robot " + pose->robot;
  const auto& command = std::get<CommandEvent>(order);
  std::string verb(word(command.verb));
  if (command.closure >= 0) return verb + " closure " + std::to_string(command.closure);
  if (!command.robot.empty()) return verb + " robot " + command.robot;
  return verb;
}

}  // namespace isthmus
