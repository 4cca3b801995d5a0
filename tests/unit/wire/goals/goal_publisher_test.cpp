#include "server/wire/goals/goal_publisher.hpp"

#include <gtest/gtest.h>

#include <mutex>

#include "isthmus/goal_t.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/ground_scenes.hpp"
#include "tests/support/published.hpp"
#include "tests/support/waiting.hpp"

namespace isthmus {
namespace {

/// A corridor along x of which a robot saw 6 m each way.
std::shared_ptr<const MapCopy> corridor_map() {
  Map map;
  map.add(testing::round_patch(testing::corridor(), PatchId{0}, {}, 6), {2, 0, 0});
  return testing::shared_copy(map);
}

RobotPose pose_of(const std::string& robot, double x) {
  RobotPose pose;
  pose.utime = 6'000'000;
  pose.robot = robot;
  pose.pose = {PatchId{0}, {x, 0, 0}};
  return pose;
}

const ExplorationConfiguration exploring = {true, 0.1, 0.5, {}, 0};

class GoalPublisherTest : public ::testing::Test {
 protected:
  std::vector<goal_t> goals(const std::string& robot) { return published_.of<goal_t>(robot + "_GOAL"); }

  Published published_;
};

TEST_F(GoalPublisherTest, TellsEachRobotItsGoalAndTheWayThere) {
  GoalPublisher goals_of(published_.sink(), exploring);
  goals_of.note(pose_of("R1", 0.4));
  goals_of.note(pose_of("R2", 1.4));
  goals_of.offer(corridor_map(), 7'000'000);
  ASSERT_TRUE(happens([&] { return !goals("R1").empty() && !goals("R2").empty(); }));
  const goal_t one = goals("R1").front(), other = goals("R2").front();
  EXPECT_EQ(one.utime, 7'000'000);
  EXPECT_EQ(one.pose_utime, 6'000'000);
  EXPECT_NEAR(one.pose.map_from_robot[0], 2.4, 1e-9);
  EXPECT_EQ(one.robot, "R1");
  EXPECT_EQ(one.reason, "frontier");
  EXPECT_EQ(one.island, 0);
  EXPECT_TRUE(one.has_goal);
  EXPECT_TRUE(one.at_goal);
  EXPECT_GT(one.id, 0);
  EXPECT_NE(one.id, other.id);
  EXPECT_GT(one.gain_m2, 0.3);
  ASSERT_GT(one.nposes, 1);
  EXPECT_NEAR(one.poses.front().patch_from_robot[0], 0.4, 1e-9);
  EXPECT_NEAR(one.poses.front().map_from_robot[0], 2.4, 1e-9);
  EXPECT_NEAR(one.poses.back().map_from_robot[0], one.goal.map_from_robot[0], 0.01);
  EXPECT_LT((one.goal.map_from_robot[0] - 2) * (other.goal.map_from_robot[0] - 2), 0);
}

TEST_F(GoalPublisherTest, WhoeverLooksIsShownTheTeamWithAllFrontiersAndNobodyOnceItIsSilent) {
  std::mutex mutex;
  std::vector<TeamGoals> shown;
  const auto show = [&](TeamGoals team) {
    const std::lock_guard lock(mutex);
    shown.push_back(std::move(team));
  };
  const auto seen = [&](std::size_t count) {
    const std::lock_guard lock(mutex);
    return shown.size() >= count;
  };
  GoalLimits limits;
  limits.silent = std::chrono::seconds(1);
  GoalPublisher goals_of(published_.sink(), exploring, show, limits);
  goals_of.note(pose_of("R1", 0.4));
  goals_of.offer(corridor_map(), 7'000'000);
  ASSERT_TRUE(happens([&] { return seen(1); }));
  ASSERT_EQ(shown[0].goals.size(), 1U);
  EXPECT_EQ(shown[0].goals[0].robot, "R1");
  EXPECT_EQ(shown[0].goals[0].goal.map_from_robot[0], goals("R1").front().goal.map_from_robot[0]);
  ASSERT_EQ(shown[0].frontiers.size(), 2U) << "at either end of what was seen";
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  goals_of.offer(corridor_map(), 17'000'000);
  ASSERT_TRUE(happens([&] { return seen(2); }));
  EXPECT_TRUE(shown[1].goals.empty());
  EXPECT_TRUE(shown[1].frontiers.empty());
}

// It looks around where it stands first.
TEST_F(GoalPublisherTest, ARobotTooLargeForTheMapIsToldThatNothingIsLeft) {
  GoalPublisher goals_of(published_.sink(), exploring);
  goals_of.note_radius("R1", 1.0);
  RobotPose pose = pose_of("R1", 0);
  goal_t last;
  for (std::size_t told = 0; told < 8 && last.reason != "finished"; ++told) {
    goals_of.note(pose);
    goals_of.offer(corridor_map(), static_cast<std::int64_t>(told + 1) * 1'000'000);
    ASSERT_TRUE(happens([&] { return goals("R1").size() > told; }));
    last = goals("R1").back();
    if (!last.has_goal) continue;
    EXPECT_NEAR(last.goal.map_from_robot[0], 2, 1e-9) << "no drive is possible";
    pose.pose.patch_from_object.yaw = last.goal.patch_from_robot[2];
  }
  EXPECT_EQ(last.reason, "finished");
  EXPECT_FALSE(last.has_goal);
  EXPECT_EQ(last.nposes, 0);
}

TEST_F(GoalPublisherTest, ARobotThatIsSilentForLongIsNotPlannedFor) {
  GoalLimits limits;
  limits.silent = std::chrono::seconds(0);
  GoalPublisher goals_of(published_.sink(), exploring, {}, limits);
  goals_of.note(pose_of("R1", 0.4));
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  goals_of.note_radius("R2", 0.2);
  goals_of.offer(corridor_map(), 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(goals("R1").empty());
}

/// What a robot that drives in a room is told by a server of this configuration.
std::vector<goal_t> served_goals(const std::string& toml) {
  Published published;
  LiveOptions options = quick_options();
  options.toml = toml;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  std::thread engine_thread([&] { server.run(); });
  const BoxRoomRobot robot("R1");
  const auto push = [&](const Message& message) {
    inbox.push("R1", message.channel.ends_with("_SCAN"), message.utime, message.channel, message.bytes);
  };
  push(robot.introduction());
  const auto told = [&] { return !published.of<goal_t>("R1_GOAL").empty(); };
  for (int i = 0; i < 60 && !told(); ++i) {
    for (const Message& message : robot.round(i)) push(message);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  inbox.close();
  engine_thread.join();
  return published.of<goal_t>("R1_GOAL");
}

TEST(ServedGoals, AServerSendsThemWhereItsConfigurationSaysSo) {
  const std::vector<goal_t> goals = served_goals("[exploration]\nenabled = true\n");
  ASSERT_FALSE(goals.empty());
  EXPECT_EQ(goals.back().robot, "R1");
}

TEST(ServedGoals, ElseItSendsNone) {
  EXPECT_TRUE(served_goals("").empty());
  EXPECT_TRUE(served_goals("[exploration]\nclearance_m = 0.2\n").empty());
}

}  // namespace
}  // namespace isthmus
