#pragma once

#include <string>

#include "server/engine/input/event.hpp"

namespace isthmus {

/// A closure's id as it stands in report.json. Throws std::runtime_error for anything else.
std::int64_t parse_closure_id(const std::string& text);

/// A robot's name, in upper case. Throws std::runtime_error where it cannot be one.
std::string parse_robot_name(const std::string& text);

/// What `allow` takes back: the withdrawal of a closure where the text is a number, the drop of a robot
/// otherwise.
CommandEvent allow_order(const std::string& text);

/// "forbid closure 3", "drop robot R1", "refine"
std::string to_text(const CommandEvent& order);

}  // namespace isthmus
