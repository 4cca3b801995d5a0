#pragma once

#include <limits>

namespace isthmus::testing {

/// The sigma of what a sighting does not measure.
inline constexpr double unmeasured = std::numeric_limits<double>::infinity();

}  // namespace isthmus::testing
