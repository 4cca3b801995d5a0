#include "server/exploration/explore.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::slim;

/// A corridor along x of which a robot saw 6 m each way: frontiers at both ends.
struct Corridor {
  Planner planner;
  std::map<std::string, Explorer> team;

  Corridor() {
    Map map;
    map.add(testing::round_patch(testing::corridor(), PatchId{0}, {}, 6), {});
    planner.update(testing::shared_copy(map));
  }
  void add(const std::string& name, double x) {
    team[name] = {{PatchId{0}, {x, 0, 0}}, slim, std::nullopt, {}};
  }
  double goal_x(const std::map<std::string, ExplorationGoal>& goals, const std::string& name) {
    return planner.project(goals.at(name).viewpoint).x;
  }
};

TEST(Explore, TwoRobotsSideBySideGoToDifferentEnds) {
  Corridor corridor;
  corridor.add("R1", 0.4);
  corridor.add("R2", 1);
  ExplorationOptions options;
  const auto shared = share_frontiers(corridor.planner, corridor.team, options);
  EXPECT_LT(corridor.goal_x(shared, "R1") * corridor.goal_x(shared, "R2"), 0);
  options.sharing = Sharing::nearest;
  const auto nearest = share_frontiers(corridor.planner, corridor.team, options);
  EXPECT_GT(corridor.goal_x(nearest, "R1"), 0);
  EXPECT_GT(corridor.goal_x(nearest, "R2"), 0);
}

TEST(Explore, ARobotKeepsItsGoalWhileThatIsAFrontier) {
  Corridor corridor;
  corridor.add("R1", 0.4);
  const auto first = share_frontiers(corridor.planner, corridor.team);
  const double x = corridor.goal_x(first, "R1");
  corridor.add("R1", x > 0 ? -2 : 2);  // nearer to the other now
  EXPECT_LT(corridor.goal_x(share_frontiers(corridor.planner, corridor.team), "R1") * x, 0);
  corridor.team["R1"].goal = first.at("R1").viewpoint;
  EXPECT_GT(corridor.goal_x(share_frontiers(corridor.planner, corridor.team), "R1") * x, 0);
}

TEST(Explore, WhatARobotGaveUpIsNoGoalOfItsAgain) {
  Corridor corridor;
  corridor.add("R1", 0.4);
  const auto first = share_frontiers(corridor.planner, corridor.team);
  corridor.team["R1"].given_up.push_back(first.at("R1").viewpoint);
  const auto second = share_frontiers(corridor.planner, corridor.team);
  EXPECT_LT(corridor.goal_x(first, "R1") * corridor.goal_x(second, "R1"), 0);
  corridor.team["R1"].given_up.push_back(second.at("R1").viewpoint);
  EXPECT_TRUE(share_frontiers(corridor.planner, corridor.team).empty());
}

TEST(Explore, WhatWasGivenUpOnAnotherIslandIsNotWhatLiesThereOnThisOne) {
  Corridor corridor;
  Map map;
  for (const int id : {0, 1}) map.add(testing::round_patch(testing::corridor(), PatchId{id}, {}, 6), {});
  corridor.planner.update(testing::shared_copy(map));
  corridor.add("R1", 0.4);
  const auto first = share_frontiers(corridor.planner, corridor.team);
  ManifoldPose there = first.at("R1").viewpoint;
  there.patch = PatchId{1};  // an island of its own; both lie at the same place of their planes
  corridor.team["R1"].given_up.push_back(there);
  const auto second = share_frontiers(corridor.planner, corridor.team);
  EXPECT_GT(corridor.goal_x(first, "R1") * corridor.goal_x(second, "R1"), 0);
}

TEST(Explore, ARobotDoesNotKeepAGoalThatItGaveUp) {
  Corridor corridor;
  corridor.add("R1", 0.4);
  const auto first = share_frontiers(corridor.planner, corridor.team);
  corridor.team["R1"].goal = first.at("R1").viewpoint;
  corridor.team["R1"].given_up.push_back(first.at("R1").viewpoint);
  EXPECT_LT(
      corridor.goal_x(share_frontiers(corridor.planner, corridor.team), "R1") * corridor.goal_x(first, "R1"),
      0);
}

TEST(Explore, TheViewpointFitsAndLooksAtTheFrontier) {
  Corridor corridor;
  corridor.add("R1", 0.4);
  const auto goals = share_frontiers(corridor.planner, corridor.team);
  const ExplorationGoal& goal = goals.at("R1");
  const Path path = corridor.planner.path({corridor.team["R1"].pose, goal.viewpoint, slim});
  EXPECT_EQ(path.refusal, Refusal::none);
  EXPECT_NEAR(goal.cost_m, path.length_m, 0.1 * path.length_m + 0.3);
  EXPECT_GT(goal.gain_m2, 0.3);
  const Pose at = corridor.planner.project(goal.viewpoint);
  EXPECT_GT(at.x * std::cos(at.yaw), 0);  // outwards
}

TEST(Explore, WhereTheFirstIsShutInTheOthersStillHaveFrontiers) {
  Map map;
  testing::Walls walls = testing::corridor();
  testing::add_box(walls, -8, -0.5, -7, 0.5);  // the first robot's cell
  map.add(testing::round_patch(walls, PatchId{0}, {-7.5, 0, 0}, 6), {-7.5, 0, 0});
  map.add(testing::round_patch(walls, PatchId{1}, {}, 6), {});
  map.relate(testing::odometry_relation(PatchId{0}, PatchId{1}, {7.5, 0, 0}));
  Planner planner;
  planner.update(testing::shared_copy(map));
  const std::map<std::string, Explorer> team = {{"R1", {{PatchId{0}, {}}, slim, std::nullopt, {}}},
                                                {"R2", {{PatchId{1}, {}}, slim, std::nullopt, {}}}};
  const auto goals = share_frontiers(planner, team);
  EXPECT_FALSE(goals.contains("R1"));
  EXPECT_TRUE(goals.contains("R2"));
}

TEST(Explore, ARobotThatStandsNowhereHasNoGoal) {
  Corridor corridor;
  corridor.team["R1"] = {{PatchId{7}, {}}, slim, std::nullopt, {}};
  corridor.team["R2"] = {{PatchId{0}, {0, 50, 0}}, slim, std::nullopt, {}};
  EXPECT_TRUE(share_frontiers(corridor.planner, corridor.team).empty());
}

/// The same, with a place in it that is to be searched.
struct SearchedCorridor : Corridor {
  SearchedCorridor(double place_x, double radius_m) {
    MapCopy copy = planner.map();
    AnnotationRecord place;
    place.name = "Search";
    place.island = PatchId{0};
    place.points = {{PatchId{0}, {place_x, 0, 0}}};
    copy.annotations = {place};
    planner.update(std::make_shared<const MapCopy>(copy));
    options.search = {"search", radius_m};
  }
  ExplorationOptions options;
};

TEST(Explore, OneRobotIsSentToWhereNobodyHasSeenThePlaceYet) {
  SearchedCorridor corridor(20, 2);
  corridor.add("R1", -3);
  corridor.team["R1"].goal = ManifoldPose{PatchId{0}, {-5.5, 0, 0}};  // that it drives to already
  EXPECT_GT(corridor.goal_x(share_frontiers(corridor.planner, corridor.team, corridor.options), "R1"), 0);
  corridor.options.search.place = "another";
  EXPECT_LT(corridor.goal_x(share_frontiers(corridor.planner, corridor.team, corridor.options), "R1"), 0);
  corridor.options.search.place = "search";
  corridor.add("R2", 3);
  const auto goals = share_frontiers(corridor.planner, corridor.team, corridor.options);
  EXPECT_LT(corridor.goal_x(goals, "R1"), 0) << "the nearer one goes, the other goes on";
  EXPECT_GT(corridor.goal_x(goals, "R2"), 0);
}

TEST(Explore, WhatLiesAroundThePlaceComesFirstAndNothingOnceItIsSeen) {
  SearchedCorridor corridor(4, 3);
  corridor.add("R1", -3);
  EXPECT_GT(corridor.goal_x(share_frontiers(corridor.planner, corridor.team, corridor.options), "R1"), 0);
  corridor.options.search.radius_m = 1;
  EXPECT_LT(corridor.goal_x(share_frontiers(corridor.planner, corridor.team, corridor.options), "R1"), 0)
      << "the place is seen, and no frontier is near it";
}

}  // namespace
}  // namespace isthmus
