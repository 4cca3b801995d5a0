#include "server/wire/foxglove/map_feed.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus::foxglove {
namespace {

using Json = nlohmann::json;
using std::chrono::milliseconds;
using testing::map_of_islands;

/// A viewer that has subscribed to all there is, each channel as it opens; topics and messages as they come.
class FoxgloveFeed : public ::testing::Test {
 protected:
  FoxgloveFeed() : viewer_(broadcast_.join([] {})) { take(); }

  void take() {
    while (const auto item = viewer_.outbox().next()) {
      const Json told = Json::parse(*item->body);
      if (item->is_data) {
        messages_[topics_.at(item->channel)].push_back(told);
      } else if (told.at("op") == "advertise") {
        for (const Json& channel : told.at("channels")) subscribe(channel.at("id"), channel.at("topic"));
      } else if (told.at("op") == "unadvertise") {
        for (const std::uint32_t id : told.at("channelIds")) withdrawn_.push_back(topics_.at(id));
      }
    }
  }
  void subscribe(std::uint32_t id, const std::string& topic) {
    topics_[id] = topic;
    if (topic == deaf_to_) return;
    const Json one = {{"id", id}, {"channelId", id}};
    broadcast_.hear(viewer_, Json{{"op", "subscribe"}, {"subscriptions", {one}}}.dump());
  }
  /// Shows a map so long after the first; subscriptions to what is new get theirs with the next.
  void show(const MapCopy& map, int ms) {
    feed_.show(map, status_, start_ + milliseconds(ms));
    take();
  }
  void show_twice(const MapCopy& map, int ms) {
    show(map, ms);
    show(map, ms);
  }
  RobotPose pose_of(const std::string& robot, IslandId island, const Pose& pose) const {
    RobotPose shown;
    shown.robot = robot;
    shown.utime = 7'000'000;
    shown.island = island;
    shown.map_from_robot = pose;
    return shown;
  }

  Broadcast broadcast_{"now", {}};
  MapFeed feed_{broadcast_};
  Viewer& viewer_;
  std::string deaf_to_;
  status_t status_;
  MapFeed::Clock::time_point start_ = MapFeed::Clock::now();
  std::map<std::uint32_t, std::string> topics_;
  std::map<std::string, std::vector<Json>> messages_;
  std::vector<std::string> withdrawn_;
};

TEST_F(FoxgloveFeed, ShowsRobotsWithTheirLasersAndScans) {
  RobotEvent robot;
  robot.robot = "R1";
  robot.laser.robot_from_laser = {0.2, 0, 0};
  robot.laser.range_max_m = 30;
  feed_.show(robot);
  take();
  EXPECT_TRUE(feed_.wants_scans());
  feed_.show(ScanEvent{"R1", {7'000'000, 0, 0.1, {1, 2, 3}}});
  feed_.show(pose_of("R1", IslandId{4}, {1, 2, 0}));
  take();
  ASSERT_EQ(messages_["/R1/scan"].size(), 1U);
  EXPECT_EQ(messages_["/R1/scan"][0].at("ranges").size(), 3U);
  ASSERT_EQ(messages_["/R1/pose"].size(), 1U);
  EXPECT_EQ(messages_["/R1/pose"][0].at("frame_id"), "island-4");
  const Json frames = messages_["/tf"].at(0).at("transforms");
  EXPECT_EQ(frames.at(0).at("parent_frame_id"), "island-4");
  EXPECT_EQ(frames.at(0).at("child_frame_id"), "R1");
  EXPECT_EQ(frames.at(1).at("child_frame_id"), "R1/laser");
  EXPECT_EQ(frames.at(1).at("translation").at("x"), 0.2);
}

TEST_F(FoxgloveFeed, ScansOfARobotThatDidNotIntroduceItselfAreNotShown) {
  feed_.show(ScanEvent{"R9", {1, 0, 0.1, {1}}});
  take();
  feed_.show(ScanEvent{"R9", {2, 0, 0.1, {1}}});
  take();
  EXPECT_TRUE(messages_["/R9/scan"].empty());
}

TEST_F(FoxgloveFeed, AGridIsSentAsItChangesAndNoMoreThanEveryTwoSeconds) {
  MapCopy map = map_of_islands({{{0, 0, 0}, {1, 0, 0}}});
  auto& grids = messages_["/island-0/grid"];
  show_twice(map, 0);
  EXPECT_EQ(grids.size(), 1U);
  show(map, 5000);
  EXPECT_EQ(grids.size(), 1U);  // nothing changed
  map.poses[1].x += 0.5;
  show(map, 6000);
  EXPECT_EQ(grids.size(), 2U);
  map.poses[1].x += 0.5;
  show(map, 7900);
  EXPECT_EQ(grids.size(), 2U);
  show(map, 8100);
  EXPECT_EQ(grids.size(), 3U);
}

TEST_F(FoxgloveFeed, WhatNobodyListensToIsNotDrawn) {
  deaf_to_ = "/island-0/grid";
  show_twice(map_of_islands({{{0, 0, 0}}}), 0);
  EXPECT_TRUE(messages_["/island-0/grid"].empty());
  EXPECT_FALSE(messages_["/scene"].empty());
}

TEST_F(FoxgloveFeed, AnIslandThatMergedIsTakenAway) {
  MapCopy map = map_of_islands({{{0, 0, 0}}, {{5, 0, 0}}});
  show_twice(map, 0);
  EXPECT_EQ(messages_["/scene"].back().at("entities").size(), 2U);
  EXPECT_EQ(messages_["/island-1/grid"].size(), 1U);
  EXPECT_EQ(messages_["/tf"].back().at("transforms").size(), 2U);
  map.graph.add(testing::odometry_between(0, 1));
  show(map, 5000);
  EXPECT_EQ(withdrawn_, std::vector<std::string>{"/island-1/grid"});
  EXPECT_EQ(messages_["/scene"].back().at("deletions").at(0).at("id"), "island-1");
  EXPECT_EQ(messages_["/scene"].back().at("entities").size(), 1U);
}

TEST_F(FoxgloveFeed, ClosuresAndWarningsAreToldAsTheyChange) {
  MapCopy map = map_of_islands({{{0, 0, 0}}});
  map.closures.resize(1);
  map.closures[0].id = ClosureId{0};
  show(map, 0);
  EXPECT_TRUE(messages_["/log"].empty());  // it waits
  map.closures[0].state = ClosureState::accepted;
  status_.warnings.resize(1);
  status_.warnings[0].kind = "clock_behind";
  status_.warnings[0].text = "R1's clock is behind";
  show(map, 1000);
  show(map, 2000);
  ASSERT_EQ(messages_["/log"].size(), 2U);
  EXPECT_EQ(messages_["/log"][0].at("message"), "closure 0 accepted");
  EXPECT_EQ(messages_["/log"][1].at("message"), "clock_behind: R1's clock is behind");
  EXPECT_EQ(messages_["/log"][1].at("level"), 3);
}

}  // namespace
}  // namespace isthmus::foxglove
