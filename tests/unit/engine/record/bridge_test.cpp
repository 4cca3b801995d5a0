#include "server/engine/record/bridge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus {
namespace {

/// Five metres, a quarter of a turn on the spot, and five metres more.
struct RoundACorner {
  std::vector<Pose> poses{Pose{2, 1, 0.5}};
  std::vector<Pose> steps;

  explicit RoundACorner(double told_share_of_turn = 1) {
    for (int i = 0; i < 20; ++i) drive({0.25, 0, 0}, {0.25, 0, 0});
    const double turn = std::numbers::pi / 2 / 5;
    for (int i = 0; i < 5; ++i) drive({0, 0, turn}, {0, 0, told_share_of_turn * turn});
    for (int i = 0; i < 20; ++i) drive({0.25, 0, 0}, {0.25, 0, 0});
  }
  void drive(const Pose& step, const Pose& told) {
    poses.push_back(poses.back() * step);
    steps.push_back(told);
  }
  /// The largest distance from where it was, of poses between its ends.
  double off_m(const std::vector<Pose>& found) const {
    double most = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
      most = std::max(most, std::hypot(found[i].x - poses[i + 1].x, found[i].y - poses[i + 1].y));
    return most;
  }
};

TEST(Bridge, BendsAWayWhereItTurned) {
  const RoundACorner way(0.85);
  std::vector<Pose> told;
  for (Pose at = way.poses.front(); const Pose& step : way.steps) told.push_back(at = at * step);
  told.pop_back();
  ASSERT_GT(way.off_m(told), 1.1);
  const std::vector<Pose> found = bridge(way.poses.front(), way.steps, way.poses.back(), {});
  ASSERT_EQ(found.size(), way.steps.size() - 1);
  EXPECT_LT(way.off_m(found), 0.1);
}

TEST(Bridge, LeavesAWayThatEndsWhereTheRobotWasFound) {
  const RoundACorner way;
  const std::vector<Pose> found = bridge(way.poses.front(), way.steps, way.poses.back(), {});
  ASSERT_EQ(found.size(), way.steps.size() - 1);
  EXPECT_LT(way.off_m(found), 1e-6);
}

TEST(Bridge, OverOneScanLiesBetween) {
  const Pose steps[] = {{0.2, 0, 0}, {0.2, 0, 0}};
  const std::vector<Pose> found = bridge({}, steps, {0.44, 0, 0}, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].x, 0.22, 1e-6);
}

TEST(Bridge, IsNoneWhereTheRobotWasCarried) {
  const RoundACorner way;
  EXPECT_TRUE(bridge(way.poses.front(), way.steps, way.poses.back() * Pose{0, 30, 0}, {}).empty());
}

}  // namespace
}  // namespace isthmus
