#include "server/wire/page/map/trails.hpp"

#include <gtest/gtest.h>

#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

RobotPose pose_at(double x, std::int64_t utime, IslandId island = PatchId{0}) {
  RobotPose pose;
  pose.robot = "R1";
  pose.utime = utime;
  pose.island = island;
  pose.pose = {PatchId{3}, {x, 0, 0}};
  pose.map_from_robot = {x, 0, 0};
  return pose;
}

TEST(Trails, StepsAreHalfAMetreApartHoweverSlowlyARobotDrives) {
  Trails trails;
  for (int i = 0; i <= 100; ++i) trails.add(pose_at(0.03 * i, i));
  const auto& trail = trails.robots().at("R1").trail;
  ASSERT_EQ(trail.size(), 6U) << "3 m";
  for (std::size_t i = 1; i < trail.size(); ++i) {
    const double step_m = trail[i].patch_from_object.x - trail[i - 1].patch_from_object.x;
    EXPECT_GT(step_m, 0.5);
    EXPECT_LT(step_m, 0.54);
  }
  EXPECT_EQ(trails.robots().at("R1").newest.utime, 100);
}

TEST(Trails, AreBounded) {
  Trails trails;
  for (int i = 0; i < 2000; ++i) trails.add(pose_at(i, 100'000 * i));
  EXPECT_EQ(trails.robots().at("R1").trail.size(), 200U);
  EXPECT_EQ(trails.robots().at("R1").lately.size(), 400U);
  EXPECT_EQ(trails.robots().at("R1").trail.back().patch_from_object.x, 1999);
}

TEST(Trails, ARobotWasWhereItsPoseNearestInTimeSays) {
  Trails trails;
  for (int i = 0; i < 10; ++i) trails.add(pose_at(i, 100'000 * i));
  EXPECT_EQ(trails.at("R1", 340'000)->patch_from_object.x, 3);
  EXPECT_EQ(trails.at("R1", 1'300'000)->patch_from_object.x, 9);
  EXPECT_FALSE(trails.at("R1", 1'500'000)) << "more than half a second later";
  EXPECT_FALSE(trails.at("R2", 340'000));
}

TEST(Trails, ARobotThatSendsFastIsKnownForAsLongAsSightingsAreShown) {
  constexpr std::int64_t step_us = 20'000;
  Trails trails;
  for (int i = 0; i <= 2000; ++i) trails.add(pose_at(i, step_us * i));
  const std::int64_t then = step_us * 2000 - 30'000'000;
  ASSERT_TRUE(trails.at("R1", then));
  EXPECT_NEAR(trails.at("R1", then)->patch_from_object.x, static_cast<double>(then) / step_us, 3);
  EXPECT_EQ(trails.robots().at("R1").newest.utime, step_us * 2000);
}

TEST(Trails, WhatTheMapTellsIsOfRobotsThatHaveNotBeenHeard) {
  Trails of_map, live;
  of_map.add(pose_at(1, 1));
  of_map.add(pose_at(2, 2));
  live.add_from_map(of_map);
  EXPECT_EQ(live.robots().at("R1").trail.size(), 2U);
  EXPECT_FALSE(live.robots().at("R1").heard);
  live.add(pose_at(3, 3));
  EXPECT_TRUE(live.robots().at("R1").heard);
  EXPECT_EQ(live.robots().at("R1").trail.size(), 3U) << "it goes on from there";
  live.add_from_map(of_map);
  EXPECT_EQ(live.robots().at("R1").newest.utime, 3) << "what was heard is newer";
  EXPECT_TRUE(live.robots().at("R1").heard);
}

TEST(Trails, OfAMapAreTheWaysOfItsSessions) {
  const Trails trails =
      trails_of(testing::shown_of(testing::map_of_a_drive({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}})));
  ASSERT_EQ(trails.robots().size(), 1U);
  EXPECT_EQ(trails.robots().at("R1").newest.utime, 3'000'000);
  EXPECT_EQ(trails.robots().at("R1").newest.pose.patch, PatchId{2});
  EXPECT_TRUE(trails_of(testing::shown_of(testing::map_of_islands({{{0, 0, 0}}}))).robots().empty());
}

TEST(Trails, OfAMapAreNotThoseOfRobotsThatWereDropped) {
  MapCopy map = testing::map_of_a_drive({{0, 0, 0}, {1, 0, 0}});
  map.left_out = {PatchId{0}};
  EXPECT_TRUE(trails_of(testing::shown_of(map)).robots().empty());
}

}  // namespace
}  // namespace isthmus
