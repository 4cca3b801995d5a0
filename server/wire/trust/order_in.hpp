#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "isthmus/command_t.hpp"

namespace isthmus {

/// What a message says that is an operator's order, in an envelope or without, whether or not it is believed
/// or can be carried out; nothing where it is none. Of an annotation or an initial pose what an answer says
/// of it: its kind, and its name or robot.
std::optional<command_t> order_in(const std::string& channel, std::span<const std::uint8_t> bytes);

}  // namespace isthmus
