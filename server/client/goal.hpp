#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "isthmus/goal_t.hpp"

namespace isthmus {

/// The goal in a message on <ROBOT>_GOAL; nothing where its bytes are none, or a number in it is not finite.
std::optional<goal_t> read_goal(std::span<const std::uint8_t> bytes);

}  // namespace isthmus
