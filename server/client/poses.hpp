#pragma once

#include <cstdint>

namespace isthmus {

/// Of one list, beyond what a server sends.
inline constexpr std::int32_t max_poses = 100'000;

}  // namespace isthmus
