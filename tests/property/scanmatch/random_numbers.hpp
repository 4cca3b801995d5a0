#pragma once

#include <rapidcheck.h>

namespace isthmus::testing {

inline double between(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 10001) / 10000.0;
}

}  // namespace isthmus::testing
