#pragma once

#include <cstdint>

namespace isthmus::testing {

/// When robots begin to send.
inline constexpr std::int64_t start_utime = 1'000'000'000;

/// The same where a scenario is simulated, as it begins unless it says otherwise.
inline constexpr std::int64_t simulated_start_utime = 1'700'000'000'000'000;

}  // namespace isthmus::testing
