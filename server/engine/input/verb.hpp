#pragma once

#include <cstdint>

#include "server/engine/input/words.hpp"

namespace isthmus {

/// What an operator orders.
enum class Verb : std::uint8_t {
  withdraw,  ///< an accepted closure is taken back, and kept from coming again
  forbid,    ///< the same before it is accepted
  allow,     ///< takes back one of these, or the drop of a robot
  drop,      ///< what a robot has contributed is left out
  refine,    ///< the whole map is fitted once more
  send_map,  ///< is published whole
};

template <>
inline constexpr auto words_of<Verb> = std::to_array<std::string_view>({
    "withdraw",
    "forbid",
    "allow",
    "drop",
    "refine",
    "send_map",
});

/// Whether it is about one closure, whatever else the order says.
constexpr bool is_about_a_closure(Verb verb) { return verb == Verb::withdraw || verb == Verb::forbid; }

}  // namespace isthmus
