#include "tools/simulate/campaigns/paths/paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

std::shared_ptr<const MapCopy> room_copy() {
  Map map;
  testing::add_round_way(map, testing::furnished_room(), {{-1, 0, 0}, {1, 0, 0}, {1, -2, 0}});
  return testing::shared_copy(map);
}

TEST(PathsCampaign, PathsInARoomKeepClearAndAreAsShortAsTheGridAllows) {
  const PathScore score = score_paths(room_copy(), 100, 1, {0.2, 0.1}, "");
  EXPECT_EQ(score.pairs, 100U);
  EXPECT_TRUE(score.missing.empty());
  EXPECT_EQ(score.through, 0U);
  EXPECT_EQ(score.too_near, 0U);
  EXPECT_EQ(score.too_long, 0U);
  EXPECT_NEAR(score.mean_ratio, 1, 0.02);
}

TEST(PathsCampaign, ARobotThatDrivesInABuildingOtherThanItsMapTouchesIt) {
  SimulatedRun run;
  RobotTruth truth{"R1", {}};
  RobotEvent robot;
  robot.robot = "R1";
  robot.laser = testing::laser_of();
  run.events.push_back({0, robot});
  for (int i = 0; i < 40; ++i) {
    const Pose pose{-2 + 0.1 * i, -1, 0};
    const std::int64_t utime = 100'000 * (i + 1);
    run.events.push_back({utime, OdometryEvent{"R1", utime, pose}});
    run.events.push_back(
        {utime, ScanEvent{"R1", testing::scan_from(testing::furnished_room(), pose, utime)}});
    truth.poses.push_back({utime, 0, pose});
  }
  run.truth = {truth};
  FloorPlan empty, walled;
  walled.segments = {{{0, -3}, {0, 3}}};
  const DriveScore free = score_drives(run, empty, 100, 30, 1, {0.2, 0.1});
  const DriveScore blocked = score_drives(run, walled, 100, 30, 1, {0.2, 0.1});
  EXPECT_EQ(free.paths, 30U);
  EXPECT_TRUE(free.missing.empty());
  EXPECT_EQ(free.touching, 0U);
  EXPECT_GT(blocked.touching, 0U);
}

}  // namespace
}  // namespace isthmus
