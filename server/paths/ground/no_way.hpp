#pragma once

#include <limits>

namespace isthmus {

/// The length of a way that there is not.
inline constexpr float no_way_m = std::numeric_limits<float>::infinity();

}  // namespace isthmus
