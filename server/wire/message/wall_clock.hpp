#pragma once

#include <chrono>
#include <cstdint>

namespace isthmus {

/// Now, for what is stamped here and not by a robot.
inline std::int64_t wall_clock_utime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace isthmus
