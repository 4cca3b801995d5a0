#include "server/engine/record/refinement.hpp"

#include <gtest/gtest.h>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

/// R1's way through a room, half a metre from patch to patch; then a scan from `truth`, which was matched
/// when less was known: its row is 4 cm off.
struct Mapped {
  static constexpr std::int64_t utime = 5'000'000;
  const Pose truth{-0.3, -1.4, 0.1};
  const Pose patch_from_robot{0.2, 0.1, 0.1};
  const Pose kept{0.24, 0.1, 0.1};
  Configuration configuration;
  MapCopy map;

  Mapped() {
    Map made;
    std::vector<Pose> way;
    for (int i = 0; i < 6; ++i) way.push_back({-2 + 0.5 * i, -1.5, 0});
    const std::vector<PatchId> patches = add_way(made, furnished_room(), way);
    for (const PatchId id : patches) {
      map.patches.push_back(made.manifold().shared_patch(id));
      map.poses.push_back(made.manifold().pose(id));
    }
    map.graph = made.graph();
    map.sessions.push_back({"R1", 0, utime, utime, patches[0]});
    auto rows = std::make_shared<TrajectoryStore>();
    rows->append({utime, 0, patches[3], kept});
    rows->flush();
    map.trajectory = rows;
    map.trajectory_rows = 1;
  }
  static Event robot(const Laser& laser) {
    RobotEvent event;
    event.robot = "R1";
    event.laser = laser;
    return {utime, event};
  }
  Event scan(const Walls& walls = furnished_room()) const {
    return {utime, ScanEvent{"R1", scan_from(walls, truth, utime)}};
  }
  /// Where the row lies after these events.
  Pose refined(const std::vector<Event>& events, std::size_t expected) const {
    Refinement refinement(map, configuration);
    for (const Event& event : events) refinement.take(event);
    EXPECT_EQ(refinement.refined(), expected);
    const std::vector<TrajectoryRow> rows = refinement.finish()->read(0, 10);
    EXPECT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows.at(0).patch, PatchId{3});
    return rows.at(0).patch_from_robot;
  }
};

double off_m(const Pose& a, const Pose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(Refinement, MatchesAScanWithTheMapAsItIsNow) {
  const Mapped its;
  EXPECT_LT(off_m(its.refined({Mapped::robot(laser_of()), its.scan()}, 1), its.patch_from_robot), 0.015);
}

TEST(Refinement, LeavesARowWhoseScanDoesNotComeAgain) {
  const Mapped its;
  EXPECT_EQ(its.refined({Mapped::robot(laser_of())}, 0), its.kept);
}

TEST(Refinement, LeavesAScanOfARobotThatNobodyHasDeclared) {
  const Mapped its;
  EXPECT_EQ(its.refined({its.scan()}, 0), its.kept);
}

TEST(Refinement, TakesNoScanThatHasNoRow) {
  const Mapped its;
  Event other = its.scan();
  std::get<ScanEvent>(other.body).scan.utime += 1;
  EXPECT_EQ(its.refined({Mapped::robot(laser_of()), other}, 0), its.kept);
}

TEST(Refinement, LeavesAScanThatFitsBadly) {
  Mapped its;
  its.configuration.engine.localise.min_score = 1.01;  // more than any match has
  EXPECT_EQ(its.refined({Mapped::robot(laser_of()), its.scan()}, 0), its.kept);
}

TEST(Refinement, BelievesTheConfigurationOfALaserAndNotTheRobot) {
  Mapped its;
  its.configuration.robots["R1"].robot.laser = laser_of();
  its.configuration.robots["R1"].declared = true;
  Laser blind = laser_of();
  blind.range_max_m = 0.1;
  EXPECT_NE(its.refined({Mapped::robot(blind), its.scan()}, 1), its.kept);
  its.configuration.robots["R1"].declared = false;
  EXPECT_EQ(its.refined({Mapped::robot(blind), its.scan()}, 0), its.kept) << "only its channels were given";
}

TEST(Refinement, MatchesWithNothingWhereNoPatchIsToBeMatchedWith) {
  Mapped its;
  its.configuration.engine.surroundings.reach_m = 0;
  EXPECT_EQ(its.refined({Mapped::robot(laser_of()), its.scan()}, 0), its.kept);
}

}  // namespace
}  // namespace isthmus
