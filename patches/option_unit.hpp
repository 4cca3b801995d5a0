#pragma once

#include <limits>

namespace isthmus {

/// The unit of an option, as `visit_options` names it.
struct OptionUnit {
  const char* text;
  double max = std::numeric_limits<double>::infinity();  ///< more is nothing in this unit

  // Not explicit: most units are but a word.
  constexpr OptionUnit(const char* unit) : text(unit) {}
  constexpr OptionUnit(const char* unit, double most) : text(unit), max(most) {}
};

/// Of options that are a part of a whole.
inline constexpr OptionUnit share_unit{"share", 1};

}  // namespace isthmus
