#pragma once

#include <gtest/gtest.h>

#include <numbers>

#include "patches/pose.hpp"

namespace isthmus::testing {

inline constexpr double quarter_turn = std::numbers::pi / 2;

inline void expect_near(const Pose& a, const Pose& b, double tolerance_m, double tolerance_rad) {
  EXPECT_NEAR(a.x, b.x, tolerance_m);
  EXPECT_NEAR(a.y, b.y, tolerance_m);
  EXPECT_NEAR(wrap_angle(a.yaw - b.yaw), 0, tolerance_rad);
}

/// The same tolerance in metres and radians.
inline void expect_near(const Pose& a, const Pose& b, double tolerance = 1e-9) {
  expect_near(a, b, tolerance, tolerance);
}

}  // namespace isthmus::testing
