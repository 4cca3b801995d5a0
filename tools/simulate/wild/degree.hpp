#pragma once

#include <numbers>

namespace isthmus {

/// In radians.
inline constexpr double degree = std::numbers::pi / 180;

}  // namespace isthmus
