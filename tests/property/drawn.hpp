#pragma once

#include <rapidcheck.h>

#include "patches/pose.hpp"

namespace isthmus::testing {

/// Drawn between two numbers; a case that fails is shrunk towards the lower.
inline double between(double low, double high) {
  return low + (high - low) * (*rc::gen::inRange(0, 1'000'001)) / 1e6;
}

/// Within a square of 2 reach_m about the origin, turned by at most 3.1 rad.
inline Pose any_pose(double reach_m) {
  return {between(-reach_m, reach_m), between(-reach_m, reach_m), between(-3.1, 3.1)};
}

}  // namespace isthmus::testing
