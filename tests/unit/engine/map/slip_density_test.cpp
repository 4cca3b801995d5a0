#include "server/engine/map/slip_density.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace isthmus {
namespace {

// Over rings of the plane and the whole circle. Half of all slips are within sqrt(3) of their scale, and of
// those beyond a large distance r there are slip_m / r.
TEST(LogSlipDensity, IsOfASlipOfSomeKindInAll) {
  const WeakLinkOptions its;
  double within_100_m = 0;
  double within_root_3 = 0;
  constexpr double step_m = 0.01, step_rad = 0.01;
  for (double r = step_m / 2; r < 100; r += step_m) {
    const double ring = 2 * std::numbers::pi * r * step_m * std::exp(log_slip_density({r, 0, 0}, its));
    within_100_m += ring;
    if (r < std::sqrt(3) * its.slip_m) within_root_3 += ring;
  }
  const double at_no_turn = std::exp(log_slip_density({0, 0, 0}, its));
  double of_yaw = 0;
  for (double yaw = -std::numbers::pi + step_rad / 2; yaw < std::numbers::pi; yaw += step_rad)
    of_yaw += step_rad * std::exp(log_slip_density({0, 0, yaw}, its)) / at_no_turn;
  EXPECT_NEAR(within_100_m * of_yaw, 1 - its.slip_m / 100, 2e-3);
  EXPECT_NEAR(within_root_3 / within_100_m, 0.5, 1e-2);
}

TEST(LogSlipDensity, HasTailsInWhichAJumpOfAHundredMetresIsRareAndNotUnheardOf) {
  const WeakLinkOptions its;
  const double tenfold = log_slip_density({10, 0, 0}, its) - log_slip_density({100, 0, 0}, its);
  EXPECT_NEAR(tenfold, 3 * std::log(10), 0.02) << "the third power, and not the square's exponential";
  EXPECT_DOUBLE_EQ(log_slip_density({1, 2, 0.1}, its),
                   log_slip_density({-2, 1, 2 * std::numbers::pi + 0.1}, its));
}

}  // namespace
}  // namespace isthmus
