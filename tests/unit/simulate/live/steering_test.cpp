#include "tools/simulate/live/steering.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace isthmus {
namespace {

constexpr double radius_m = 0.22;
constexpr double margin_m = 0.05;

TEST(Steering, OverOpenGroundItGoesStraightAtFullSpeed) {
  const Motion motion = steer({}, radius_m, {2, 0}, {}, margin_m);
  EXPECT_EQ(motion.speed_mps, DrivePlan{}.speed_mps);
  EXPECT_EQ(motion.turn_rate_rps, 0);
}

TEST(Steering, BeforeAWallItDoesNotGoOn) {
  std::vector<Eigen::Vector2d> wall;
  for (int i = -40; i <= 40; ++i) wall.emplace_back(0.3, 0.02 * i);
  EXPECT_EQ(steer({}, radius_m, {2, 0}, wall, margin_m).speed_mps, 0);
}

TEST(Steering, RoundSomethingInTheWayItTurns) {
  const std::vector<Eigen::Vector2d> something{{0.6, 0.1}};
  const Motion motion = steer({}, radius_m, {2, 0}, something, margin_m);
  EXPECT_GT(motion.speed_mps, 0);
  EXPECT_LT(motion.turn_rate_rps, 0);
}

TEST(Steering, TowardsWhatLiesBehindItTurnsOnTheSpot) {
  const Motion motion = steer({}, radius_m, {-1, 0.2}, {}, margin_m);
  EXPECT_EQ(motion.speed_mps, 0);
  EXPECT_GT(motion.turn_rate_rps, 0);
}

}  // namespace
}  // namespace isthmus
