#pragma once

namespace isthmus {

/// What the pictures have in common, in heights of a line of text.
inline constexpr double margin_em = 1.2;
inline constexpr double title_size_em = 1.35;
inline constexpr double entry_em = 1.45;  ///< from entry to entry of a legend
inline constexpr double small_em = 0.9;   ///< the axes' text
inline constexpr double tick_em = 0.35;
inline constexpr double x_tick_step_em = 5;  ///< at least

}  // namespace isthmus
