#pragma once

#include "patches/ring.hpp"

namespace isthmus::testing {

inline Ring rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

}  // namespace isthmus::testing
