#include "server/exploration/expedition.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::slim;

/// A corridor along x of which a robot saw 6 m each way: frontiers at both ends.
struct Team {
  Planner planner;
  Expedition expedition;
  std::map<std::string, ExpeditionMember> members;

  explicit Team(const ExpeditionOptions& options = {}) : expedition(options) {
    Map map;
    map.add(testing::round_patch(testing::corridor(), PatchId{0}, {}, 6), {});
    planner.update(testing::shared_copy(map));
  }
  void put(const std::string& name, const Pose& pose) { members[name] = {{PatchId{0}, pose}, slim}; }
  ExplorationOrder order_at(double time_s, const std::string& name = "R1") {
    return expedition.plan(planner, members, time_s).at(name);
  }
  double x_of(const ManifoldPose& pose) const { return planner.project(pose).x; }
};

TEST(Expedition, ARobotIsSentToAFrontierAndKeepsItAsItDrives) {
  Team team;
  team.put("R1", {0.4, 0, 0});
  const ExplorationOrder first = team.order_at(0);
  EXPECT_EQ(first.reason, OrderReason::frontier);
  EXPECT_TRUE(first.is_last);
  EXPECT_NEAR(team.x_of(first.path.back()), team.x_of(first.goal->viewpoint), 0.01);
  team.put("R1", {2, 0, 0});
  const ExplorationOrder second = team.order_at(3);
  EXPECT_EQ(second.number, first.number);
  EXPECT_LT(second.goal->cost_m, first.goal->cost_m + 0.1);
}

TEST(Expedition, WhoHasComeToItsGoalIsGivenAnother) {
  Team team;
  team.put("R1", {0.4, 0, 0});
  const ExplorationOrder first = team.order_at(0);
  Pose there = team.planner.project(first.goal->viewpoint);
  there.yaw = wrap_angle(there.yaw + 3);  // it has still to look
  team.put("R1", there);
  EXPECT_EQ(team.order_at(10).number, first.number);
  there.yaw = wrap_angle(there.yaw - 3);
  team.put("R1", there);
  const ExplorationOrder second = team.order_at(12);
  EXPECT_GT(second.number, first.number);
  EXPECT_LT(team.x_of(second.goal->viewpoint) * team.x_of(first.goal->viewpoint), 0);
  EXPECT_EQ(team.expedition.counts().given_up, 0U);
}

TEST(Expedition, WhatARobotSawNothingNewAtTwiceIsNoGoalAgain) {
  Team team;
  team.put("R1", {0.4, 0, 0});
  double time_s = 0;
  int goals = 0;
  for (; goals < 20; ++goals) {
    const ExplorationOrder order = team.order_at(time_s += 10);
    if (order.reason == OrderReason::finished) break;
    team.put("R1", team.planner.project(order.goal->viewpoint));
  }
  EXPECT_GE(goals, 4);
  EXPECT_LE(goals, 6);
}

TEST(Expedition, WhatOneRobotSawNothingNewAtIsNoGoalForTheOthers) {
  Team team;
  team.put("R1", {-1, 0, 3.1});
  team.put("R2", {1, 0, 0});
  int came = 0;
  for (double time_s = 0; time_s < 200; time_s += 10) {
    const auto orders = team.expedition.plan(team.planner, team.members, time_s);
    for (const auto& [name, order] : orders) {
      if (order.reason == OrderReason::finished || !order.is_last) continue;
      team.put(name, team.planner.project(order.goal->viewpoint));
      ++came;
    }
  }
  EXPECT_GE(came, 4);
  EXPECT_LE(came, 6) << "as many as one robot alone goes to";
}

TEST(Expedition, WhoDoesNotGetOnGivesItsGoalUp) {
  Team team;
  team.put("R1", {0.4, 0, 0});
  const ExplorationOrder first = team.order_at(0);
  EXPECT_EQ(team.order_at(10).number, first.number);
  const ExplorationOrder second = team.order_at(19);
  EXPECT_NE(second.number, first.number);
  EXPECT_LT(team.x_of(second.goal->viewpoint) * team.x_of(first.goal->viewpoint), 0);
  EXPECT_EQ(team.expedition.counts().given_up, 1U);
}

TEST(Expedition, WhoHasToWaitForAnotherTooLongIsGivenAnotherGoalForAWhile) {
  ExpeditionOptions options;
  options.first_turns = 0;
  options.coordination.margin_m = 30;  // nobody may come nearer to another
  Team team(options);
  team.put("R1", {-1, 0, 3.1});
  team.put("R2", {1, 0, 0});
  ASSERT_EQ(team.order_at(0, "R1").reason, OrderReason::frontier);
  ASSERT_EQ(team.order_at(0, "R2").reason, OrderReason::frontier) << "they drive apart";
  team.put("R1", {2, 0, 3.1});  // and now each is in the other's way
  team.put("R2", {-2, 0, 0});
  const bool first_waits = team.order_at(1, "R1").reason == OrderReason::wait;
  const std::string waits = first_waits ? "R1" : "R2", drives = first_waits ? "R2" : "R1";
  const double side = first_waits ? 1 : -1;
  for (int i = 1; i <= 7; ++i) {
    ASSERT_EQ(team.order_at(2 * i, waits).reason, OrderReason::wait) << i;
    team.put(drives, {side * (-2 + 0.35 * i), 0, first_waits ? 0 : 3.1});
  }
  EXPECT_FALSE(team.order_at(17, waits).goal.has_value());  // the other end is the other robot's
  EXPECT_EQ(team.expedition.counts().given_up, 0U);
  team.put(drives, {side * 5, 0, first_waits ? 0 : 3.1});
  EXPECT_TRUE(team.order_at(34, waits).goal.has_value());
}

TEST(Expedition, WhoSeesNoFrontierFromWhereItBeginsLooksAroundThere) {
  testing::Walls walls;
  testing::add_box(walls, -2, -2, 2, 2);
  Map map;
  map.add(testing::round_patch(walls, PatchId{0}, {}, 6), {});
  Team team;
  team.planner = Planner();
  team.planner.update(testing::shared_copy(map));
  Pose pose{0, 0, 0.5};
  team.put("R1", pose);
  std::set<std::int64_t> numbers;
  double turned_rad = 0;
  for (int turn = 0; turn < 3; ++turn) {
    const ExplorationOrder order = team.order_at(5 * turn);
    ASSERT_EQ(order.reason, OrderReason::frontier) << turn;
    EXPECT_TRUE(order.is_last);
    const Pose goal = team.planner.project(order.goal->viewpoint);
    EXPECT_NEAR(goal.x, 0, 1e-9);
    turned_rad += std::abs(wrap_angle(goal.yaw - pose.yaw));
    numbers.insert(order.number);
    team.put("R1", pose = goal);
  }
  EXPECT_NEAR(turned_rad, 2 * std::numbers::pi, 1e-6);
  EXPECT_EQ(numbers.size(), 3U);
  EXPECT_EQ(team.order_at(20).reason, OrderReason::finished);
  EXPECT_EQ(team.expedition.counts().given_up, 0U);
}

TEST(Expedition, ARobotThatIsNotOnTheMapHasNoOrder) {
  Team team;
  team.put("R1", {0.4, 0, 0});
  team.members["R2"] = {{PatchId{9}, {}}, slim};
  EXPECT_EQ(team.expedition.plan(team.planner, team.members, 0).size(), 1U);
}

/// Two corridors, of an island each, on which a meeting is on offer.
struct Teams : Team {
  explicit Teams(double a_x_m) {
    Map map;
    map.add(testing::round_patch(testing::corridor(), PatchId{0}, {}, 6), {});
    map.add(testing::round_patch(testing::corridor(), PatchId{1}, {}, 6), {});
    copy = testing::copy_of(map);
    copy.meeting = MeetingRecord{ClosureId{4}, {"R1", {PatchId{0}, {a_x_m, 0, 0}}}, {"R2", {PatchId{1}, {}}}};
    members["R1"] = {{PatchId{0}, {}}, slim};
    members["R2"] = {{PatchId{1}, {0.4, 0, 0}}, slim};
    update();
  }
  void update() { planner.update(std::make_shared<const MapCopy>(copy)); }
  MapCopy copy;
};

TEST(Expedition, TwoRobotsAreSentToAMeetingThatIsWorthMoreThanNewGround) {
  Teams near(1);
  const ExplorationOrder order = near.order_at(0, "R1");
  EXPECT_EQ(order.reason, OrderReason::meet);
  EXPECT_NEAR(near.x_of(order.path.back()), 1, 0.1);
  EXPECT_EQ(near.order_at(0, "R2").reason, OrderReason::meet);
  EXPECT_EQ(near.expedition.counts().meetings, 1U);
  Teams far(5);
  EXPECT_EQ(far.order_at(0, "R1").reason, OrderReason::frontier) << "ten metres there and back";
  EXPECT_EQ(far.expedition.counts().meetings, 0U);
}

TEST(Expedition, AMeetingEndsWhenItIsSettledAndEachExploresAgain) {
  Teams teams(1);
  teams.order_at(0);
  teams.copy.meeting.reset();
  teams.update();
  EXPECT_EQ(teams.order_at(1, "R1").reason, OrderReason::frontier);
  EXPECT_EQ(teams.order_at(1, "R2").reason, OrderReason::frontier);
}

TEST(Expedition, AMeetingThatSettlesNothingIsLeftAndNotGoneToAgain) {
  Teams teams(1);
  teams.order_at(0);
  teams.members["R1"].pose.patch_from_object.x = 1;
  teams.members["R2"].pose.patch_from_object.x = 0;
  const ExpeditionOptions options;
  EXPECT_EQ(teams.order_at(options.meet_s - 1, "R1").reason, OrderReason::meet);
  for (const double time_s : {options.meet_s + 1, options.meet_s + 5, options.meet_s + 10}) {
    EXPECT_EQ(teams.order_at(time_s, "R1").reason, OrderReason::frontier) << time_s;
    EXPECT_EQ(teams.order_at(time_s, "R2").reason, OrderReason::frontier) << time_s;
  }
  EXPECT_EQ(teams.expedition.counts().meetings, 1U);
}

TEST(Expedition, WhoCannotComeToTheMeetingIsNotSentThere) {
  Teams teams(1);
  teams.copy.meeting->a.pose.patch_from_object.y = 30;
  teams.update();
  EXPECT_EQ(teams.order_at(0, "R1").reason, OrderReason::frontier);
}

}  // namespace
}  // namespace isthmus
