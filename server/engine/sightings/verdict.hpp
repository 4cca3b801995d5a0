#pragma once

#include <cstdint>

#include "server/engine/input/words.hpp"

namespace isthmus {

/// What became of a sighting.
enum class Verdict : std::uint8_t { accepted, refused, waiting };

template <>
inline constexpr auto words_of<Verdict> = std::to_array<std::string_view>({"accepted", "refused", "waiting"});

}  // namespace isthmus
