#pragma once

#include <cstdint>

namespace isthmus {

/// Of one scan; one with more is refused.
constexpr std::int32_t max_beams = 20'000;

/// Of one annotation_t.
constexpr std::int32_t max_annotation_points = 64;

}  // namespace isthmus
