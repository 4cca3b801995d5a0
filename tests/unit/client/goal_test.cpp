#include "server/client/goal.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

goal_t goal_of(int poses) {
  goal_t goal{};
  goal.id = 7;
  goal.robot = "R1";
  goal.reason = "frontier";
  goal.goal.patch = 3;
  goal.at_goal = 1;
  goal.poses.resize(static_cast<std::size_t>(poses));
  for (path_pose_t& pose : goal.poses) pose = {};
  goal.nposes = poses;
  return goal;
}

TEST(Goal, IsReadAsItWasSent) {
  const auto goal = read_goal(encoded(goal_of(3)));
  ASSERT_TRUE(goal);
  EXPECT_EQ(goal->id, 7);
  EXPECT_EQ(goal->reason, "frontier");
  EXPECT_EQ(goal->goal.patch, 3);
  EXPECT_TRUE(goal->at_goal);
  EXPECT_EQ(goal->poses.size(), 3U);
}

TEST(Goal, BytesThatAreNoneAreNotRead) {
  std::vector<std::uint8_t> bytes = encoded(goal_of(3));
  EXPECT_FALSE(read_goal({}));
  EXPECT_FALSE(read_goal(std::span(bytes).first(bytes.size() - 1)));
  bytes[0] ^= 1;
  EXPECT_FALSE(read_goal(bytes));
}

TEST(Goal, ANumberThatIsNotFiniteIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  goal_t way = goal_of(2), goal = goal_of(1), pose = goal_of(1);
  way.poses[1].map_from_robot[0] = nan;
  goal.goal.patch_from_robot[1] = nan;
  pose.pose.map_from_robot[2] = nan;
  EXPECT_FALSE(read_goal(encoded(way)));
  EXPECT_FALSE(read_goal(encoded(goal)));
  EXPECT_FALSE(read_goal(encoded(pose)));
}

}  // namespace
}  // namespace isthmus
