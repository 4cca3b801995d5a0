#include "server/wire/page/texts/exploration_text.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;
using testing::map_of_islands;
using testing::shown_of;

path_pose_t place_on(int patch, double x) {
  path_pose_t pose{};
  pose.patch = patch;
  pose.patch_from_robot[0] = x;
  return pose;
}

/// R1 drives from patch 1 a metre ahead, to look from two metres ahead.
TeamGoals team_of_r1() {
  goal_t told{};
  told.robot = "R1";
  told.reason = "frontier";
  told.pose = place_on(1, 0);
  told.has_goal = 1;
  told.goal = place_on(1, 2);
  told.gain_m2 = 4.567;
  told.poses = {place_on(1, 0), place_on(1, 1)};
  return {{told}, {{{PatchId{0}, {1, 0, 0}}, 1.5, 3.25, 0}}};
}

/// Patch 1 looks along y.
MapCopy two_maps() { return map_of_islands({{{0, 0, 0}}, {{2, 3, std::numbers::pi / 2}}}); }

TEST(ExplorationText, GoalsWaysAndFrontiersAreWhereTheMapHasTheirPatchesNow) {
  const Json all = Json::parse(exploration_text(team_of_r1(), shown_of(two_maps())));
  EXPECT_EQ(all.at("goals"), Json::parse(R"([{"robot": "R1", "reason": "frontier", "island": 1,
      "goal": [2.0, 5.0, 1.57], "gain": 4.57, "way": [[2.0, 3.0], [2.0, 4.0]]}])"));
  EXPECT_EQ(all.at("frontiers"), Json::parse("[[0, 1.0, 0.0, 0.0, 3.25]]"));
  MapCopy merged = two_maps();
  merged.graph.add(testing::odometry_between(0, 1));
  merged.poses[1] = {7, 0, 0};
  const Json later = Json::parse(exploration_text(team_of_r1(), shown_of(merged)));
  EXPECT_EQ(later.at("goals")[0].at("island"), 0);
  EXPECT_EQ(later.at("goals")[0].at("goal"), Json::parse("[9.0, 0.0, 0.0]"));
}

TEST(ExplorationText, ARobotThatHasFinishedHasNoGoalAndNoWay) {
  TeamGoals team = team_of_r1();
  team.goals[0].reason = "finished";
  team.goals[0].has_goal = 0;
  team.goals[0].poses.clear();
  const Json goal = Json::parse(exploration_text(team, shown_of(two_maps()))).at("goals")[0];
  EXPECT_EQ(goal.at("reason"), "finished");
  EXPECT_TRUE(goal.at("goal").is_null());
  EXPECT_TRUE(goal.at("way").empty());
}

// The map may have parted since the goal was given.
TEST(ExplorationText, WhatIsNotOnTheMapOrOnAnotherIslandIsLeftOut) {
  TeamGoals team = team_of_r1();
  team.goals[0].goal = place_on(0, 2);
  team.goals[0].poses = {place_on(1, 0), place_on(0, 1), place_on(5, 1)};
  goal_t of_unknown = team.goals[0];
  of_unknown.pose = place_on(5, 0);
  team.goals.push_back(of_unknown);
  team.frontiers.push_back({{PatchId{5}, {}}, 1, 1, 0});
  team.frontiers.push_back({{PatchId{0}, {std::numeric_limits<double>::quiet_NaN(), 0, 0}}, 1, 1, 0});
  const Json all = Json::parse(exploration_text(team, shown_of(two_maps())));
  ASSERT_EQ(all.at("goals").size(), 1U);
  EXPECT_TRUE(all.at("goals")[0].at("goal").is_null());
  EXPECT_EQ(all.at("goals")[0].at("way"), Json::parse("[[2.0, 3.0]]"));
  ASSERT_EQ(all.at("frontiers").size(), 2U);
  EXPECT_EQ(all.at("frontiers")[1][1], 0);
}

}  // namespace
}  // namespace isthmus
