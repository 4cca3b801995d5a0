#pragma once

#include <cstdint>

#include "server/engine/input/words.hpp"

namespace isthmus {

/// What operators write on a map.
enum class AnnotationKind : std::uint8_t {
  place,     ///< a pose with a name
  keep_out,  ///< a zone that no robot is to be in
  speed,     ///< a zone in which robots are to drive slowly
  erase,     ///< takes away the place or zone of a name
};

template <>
inline constexpr auto words_of<AnnotationKind> = std::to_array<std::string_view>({
    "place",
    "keep_out",
    "speed",
    "erase",
});

constexpr bool is_zone(AnnotationKind kind) {
  return kind == AnnotationKind::keep_out || kind == AnnotationKind::speed;
}

}  // namespace isthmus
