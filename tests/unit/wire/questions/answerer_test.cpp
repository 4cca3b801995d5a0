#include "server/wire/questions/answerer.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/ground_scenes.hpp"
#include "tests/support/questions.hpp"

namespace isthmus {
namespace {

using testing::question_of;

/// A furnished room that R1 and R2 have seen, and another island that R3 saw.
class AnswererTest : public ::testing::Test {
 protected:
  AnswererTest() {
    testing::add_round_way(map_, testing::furnished_room(), {{-1, 0, 0}, {1, 0, 0}});
    map_.add(testing::round_patch(testing::furnished_room(), PatchId{2}, {}), {});
    for (const auto& [robot, patch] : {std::pair("R1", 0), std::pair("R2", 1), std::pair("R3", 2)}) {
      copy_.sessions.push_back(
          {robot, static_cast<std::int32_t>(copy_.sessions.size()), 0, 0, PatchId{patch}});
      robots_[robot] = {robot, 7, IslandId{0}, {PatchId{patch}, {}}, 1e-4 * Eigen::Matrix3d::Identity(),
                        {},    {}};
    }
    update(1000);
  }

  void update(std::int64_t utime) {
    MapCopy copy = testing::copy_of(map_);
    copy.sessions = copy_.sessions;
    copy.annotations = copy_.annotations;
    answerer_.update(std::make_shared<const MapCopy>(std::move(copy)), utime);
  }
  reply_t ask(const request_t& request) {
    const QuestionReading reading = read_question(request);
    EXPECT_TRUE(reading.question) << word(reading.refusal);
    return answerer_.answer(*reading.question, robots_, robots_before_);
  }
  std::string why_not(const request_t& request) {
    const reply_t reply = ask(request);
    EXPECT_FALSE(reply.done);
    EXPECT_EQ(reply.nposes, 0);
    return reply.reason;
  }

  Map map_;
  MapCopy copy_;
  RobotPoses robots_, robots_before_;
  Answerer answerer_;
};

request_t path_to_robot(const std::string& robot) {
  request_t request = question_of("path", "R1");
  request.target = "robot";
  request.target_robot = robot;
  return request;
}

TEST_F(AnswererTest, APathToATeammateLeadsFromTheOneToTheOther) {
  const reply_t reply = ask(path_to_robot("r2"));
  ASSERT_TRUE(reply.done) << reply.reason;
  EXPECT_NEAR(reply.length_m, 2, 0.1);
  ASSERT_GE(reply.nposes, 2);
  EXPECT_EQ(reply.poses.front().patch, 0);
  EXPECT_NEAR(reply.poses.front().map_from_robot[0], -1, 1e-9);
  EXPECT_NEAR(reply.poses.back().map_from_robot[0], 1, 0.05);
  EXPECT_EQ(reply.island, 0);
  EXPECT_EQ(reply.target_utime, 7);
  EXPECT_EQ(reply.map_version, 1000);
}

TEST_F(AnswererTest, APathToANamedPlaceKeepsOutOfZonesAndTellsTheSpeed) {
  AnnotationRecord dock;
  dock.name = "Dock 1";
  dock.island = PatchId{0};
  dock.points = {{PatchId{1}, {0.2, 0, 0}}};
  AnnotationRecord slow;
  slow.kind = AnnotationKind::speed;
  slow.max_speed_m_s = 0.4;
  slow.name = "slow";
  slow.island = PatchId{0};
  slow.points = {
      {PatchId{1}, {-1, -3, 0}}, {PatchId{1}, {3, -3, 0}}, {PatchId{1}, {3, 3, 0}}, {PatchId{1}, {-1, 3, 0}}};
  copy_.annotations = {dock, slow};
  update(2000);
  request_t request = question_of("path", "R1");
  request.target = "place";
  request.target_place = "dock 1";
  const reply_t reply = ask(request);
  ASSERT_TRUE(reply.done) << reply.reason;
  EXPECT_NEAR(reply.length_m, 2.2, 0.2);
  EXPECT_EQ(reply.poses.back().max_speed, 0.4);
  EXPECT_EQ(reply.poses.front().max_speed, 0);
  copy_.annotations[1].kind = AnnotationKind::keep_out;
  update(3000);
  EXPECT_EQ(why_not(request), "kept_out");
  request.target_place = "nowhere";
  EXPECT_EQ(why_not(request), "unknown_place");
  request.target_place = "slow";
  EXPECT_EQ(why_not(request), "unknown_place") << "a zone is none";
}

TEST_F(AnswererTest, HomeIsWhereTheRobotsFirstPatchOfItsIslandBegins) {
  robots_["R1"].pose = {PatchId{1}, {0.2, 0, 0}};
  request_t request = question_of("path", "R1");
  request.target = "home";
  const reply_t reply = ask(request);
  ASSERT_TRUE(reply.done) << reply.reason;
  EXPECT_NEAR(reply.poses.back().map_from_robot[0], -1, 0.05);
}

TEST_F(AnswererTest, WhereATeammateIsComesWithCovarianceAndTheRelationsItRestsOn) {
  request_t request = path_to_robot("R2");
  request.kind = "relative_pose";
  const reply_t reply = ask(request);
  ASSERT_TRUE(reply.done) << reply.reason;
  EXPECT_NEAR(reply.start_from_target[0], 2, 1e-9);
  EXPECT_GT(reply.covariance[0][0], 2e-4);
  EXPECT_EQ(reply.nchain, 1);
}

TEST_F(AnswererTest, WhatTheMapDoesNotTellIsRefusedWithTheReason) {
  EXPECT_EQ(why_not(path_to_robot("R3")), "other_island");
  EXPECT_EQ(why_not(path_to_robot("R9")), "unknown_robot");
  EXPECT_EQ(why_not(question_of("retro_traverse", "R1")), "unknown_robot") << "it has no trajectory";
  request_t request = question_of("path", "R1");
  request.target = "tag";
  EXPECT_EQ(why_not(request), "unknown_tag");
  request.target = "patch";
  request.target_patch = 99;
  EXPECT_EQ(why_not(request), "unknown_patch");
  request.target = "pose";
  request.target_patch = 1;
  request.patch_from_target[0] = 50;
  EXPECT_EQ(why_not(request), "no_room") << "outside the map";
  request.patch_from_target[0] = 1e9;
  EXPECT_EQ(why_not(request), "bad_value");
  request.patch_from_target[0] = 0;
  request.radius_m = -1;
  EXPECT_EQ(why_not(request), "bad_value");
}

TEST_F(AnswererTest, AFollowedPathIsToldAnewWhereTheMapMovesIt) {
  request_t request = path_to_robot("R2");
  request.follow_s = 10;
  const reply_t told = ask(request);
  const Question question = *read_question(request).question;
  EXPECT_FALSE(answerer_.update_of(question, told, robots_, robots_before_));
  map_.move_island(IslandId{0}, {0.5, 0, 0});
  update(2000);
  const auto moved = answerer_.update_of(question, told, robots_, robots_before_);
  ASSERT_TRUE(moved && moved->done);
  EXPECT_EQ(moved->change, "moved");
  EXPECT_EQ(moved->map_version, 2000);
  EXPECT_NEAR(moved->poses.front().map_from_robot[0], -0.5, 1e-9);
  EXPECT_FALSE(answerer_.update_of(question, *moved, robots_, robots_before_));
  robots_["R2"].pose.patch_from_object.y += 1;
  EXPECT_EQ(answerer_.update_of(question, *moved, robots_, robots_before_)->change, "target_moved");
  robots_.erase("R2");
  const auto blocked = answerer_.update_of(question, *moved, robots_, robots_before_);
  ASSERT_TRUE(blocked && !blocked->done);
  EXPECT_EQ(blocked->change, "blocked");
  EXPECT_EQ(blocked->reason, "unknown_robot");
}

TEST_F(AnswererTest, APathToAnotherIslandOpensWhenTheTwoBecomeOne) {
  request_t request = path_to_robot("R3");
  request.follow_s = 10;
  const reply_t told = ask(request);
  EXPECT_EQ(told.reason, "other_island");
  const Question question = *read_question(request).question;
  EXPECT_FALSE(answerer_.update_of(question, told, robots_, robots_before_));
  map_.relate(testing::odometry_relation(PatchId{1}, PatchId{2}, {-1, 0.5, 0}));
  update(2000);
  const auto opened = answerer_.update_of(question, told, robots_, robots_before_);
  ASSERT_TRUE(opened && opened->done) << (opened ? opened->reason : "no update");
  EXPECT_EQ(opened->change, "opened");
}

TEST_F(AnswererTest, AFootprintThatCannotBeIsRefusedForFrontiersToo) {
  request_t request = question_of("frontiers", "R1");
  request.radius_m = 1e6;
  EXPECT_EQ(why_not(request), "bad_value");
}

TEST_F(AnswererTest, ARobotOnAPatchThatTheCopyDoesNotHaveYetIsWhereItWasThen) {
  robots_before_["R1"] = robots_["R1"];
  robots_["R1"].pose.patch = PatchId{3};
  const reply_t reply = ask(path_to_robot("R2"));
  ASSERT_TRUE(reply.done) << reply.reason;
  EXPECT_EQ(reply.poses.front().patch, 0);
}

TEST_F(AnswererTest, TheVersionGrowsWithTheMapAndTellsWhichPatchesChanged) {
  update(2000);
  EXPECT_EQ(ask(question_of("map_version", "R1")).map_version, 1000) << "nothing has changed";
  map_.move_island(IslandId{2}, {1, 0, 0});
  update(3000);
  request_t request = question_of("changes", "R1");
  request.since = 1000;
  const reply_t reply = ask(request);
  EXPECT_EQ(reply.map_version, 3000);
  EXPECT_EQ(reply.changed, std::vector<std::int32_t>{2});
  request.since = 0;
  EXPECT_EQ(ask(request).nchanged, 3);
  request.since = 3001;
  EXPECT_EQ(why_not(request), "bad_value");
}

}  // namespace
}  // namespace isthmus
