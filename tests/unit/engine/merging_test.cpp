// Howard et al. 2006, IV-C, from the events on: two robots see one another, and their islands become one.

#include <gtest/gtest.h>

#include <cmath>

#include "server/engine/engine.hpp"
#include "tests/support/start_utime.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// Two robots that drive towards one another in a room, each with odometry of its own.
//
//     R1 (-3, -1) -->        <-- R2 (3, 0)
class TwoRobots {
 public:
  TwoRobots() {
    for (const auto& [name, barcode] : {std::pair{"R1", 101}, {"R2", 102}}) {
      RobotEvent robot;
      robot.robot = name;
      robot.utime = start_utime;
      robot.barcode = barcode;
      robot.laser = laser_of();
      engine.handle({start_utime, robot});
    }
  }
  // Drives on for so many scans, at 5 Hz; returns R2's last answer.
  RobotPose drive(int scans, bool seeing) {
    RobotPose last;
    for (int i = 0; i < scans; ++i, ++round_) {
      const std::int64_t utime = start_utime + 200'000 * round_;
      if (seeing) see(utime);
      for (const char* name : {"R1", "R2"}) {
        engine.handle({utime, OdometryEvent{name, utime, world(name)}});
        const Outcome outcome =
            engine.handle({utime, ScanEvent{name, scan_from(furnished_room(), world(name), utime)}});
        for (const RobotPose& pose : outcome.poses)
          if (pose.robot == "R2") last = pose;
      }
    }
    return last;
  }
  Pose world(const std::string& name) const {
    const double way_m = 0.08 * std::min(round_, 50);
    return name == "R1" ? Pose{-3 + way_m, -1, 0} : Pose{3 - way_m, 0, 3.1};
  }
  // The plane of the older island is that of R1's first patch.
  Pose older_from(const Pose& world_from_robot) const { return ominus(world_from_robot, {-3, -1, 0}); }

  Engine engine;

 private:
  void see(std::int64_t utime) {
    for (const auto& [observer, target, barcode] :
         {std::tuple{"R1", "R2", 102}, std::tuple{"R2", "R1", 101}}) {
      const Pose seen = ominus(world(target), world(observer));
      engine.handle({utime, SightingEvent{observer, utime, barcode, std::hypot(seen.x, seen.y), 0.03,
                                          std::atan2(seen.y, seen.x), 0.01}});
    }
  }

  int round_ = 0;
};

TEST(Merging, RobotsThatSeeNobodyHaveIslandsOfTheirOwn) {
  TwoRobots robots;
  robots.drive(40, false);
  EXPECT_EQ(robots.engine.copy().graph.islands().size(), 2U);
}

TEST(Merging, RobotsThatSeeOneAnotherComeToBeOnOneIsland) {
  TwoRobots robots;
  robots.drive(10, false);
  const MapCopy before = robots.engine.copy();
  ASSERT_EQ(before.graph.islands().size(), 2U);
  const RobotPose answer = robots.drive(60, true);
  const MapCopy after = robots.engine.copy();
  ASSERT_EQ(after.graph.islands().size(), 1U);
  // R2 is told where it is in the plane of the older island, on a patch where it was before.
  EXPECT_EQ(answer.island, PatchId{0});
  const Pose truth = robots.older_from({3 - 0.08 * 50, 0, 3.1});
  EXPECT_NEAR(answer.map_from_robot.x, truth.x, 0.05);
  EXPECT_NEAR(answer.map_from_robot.y, truth.y, 0.05);
  EXPECT_NEAR(wrap_angle(answer.map_from_robot.yaw - truth.yaw), 0, 0.02);
  EXPECT_EQ(after.sessions.size(), 2U) << "nobody began anew";
  for (const auto& [id, relation] : before.graph.relations()) EXPECT_NE(after.graph.find(id), nullptr);
  ASSERT_EQ(after.closures.size(), 1U);
  EXPECT_EQ(after.closures.front().kind, ClosureKind::merge);
  EXPECT_EQ(after.closures.front().state, ClosureState::accepted);
  bool seen = false;
  for (const auto& [id, relation] : after.graph.relations()) {
    seen = seen || (relation.origin.kind == OriginKind::sighting &&
                    relation.origin.closure == after.closures.front().id);
  }
  EXPECT_TRUE(seen) << "the mutual observation is a relation of the map";
}

}  // namespace
}  // namespace isthmus
