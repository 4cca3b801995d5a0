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

/// Four scans along that way, of which the two in the middle show nothing: when they came, the step to the
/// first of them was told wrong by much.
struct WithAGap : Mapped {
  static constexpr std::size_t scans = 4;
  Pose map_from_robot(std::size_t i) const { return {-0.6 + 0.2 * static_cast<double>(i), -1.4, 0.1}; }
  static std::int64_t at(std::size_t i) { return utime + 200'000 * static_cast<std::int64_t>(i); }

  WithAGap() {
    auto rows = std::make_shared<TrajectoryStore>();
    const Pose told_wrong{0.3, 0.2, 0.2};
    for (std::size_t i = 0; i < scans; ++i) {
      const bool is_blind = i == 1 || i == 2;
      const Pose said =
          map_from_robot(0) * (is_blind ? told_wrong : Pose{}) * ominus(map_from_robot(i), map_from_robot(0));
      rows->append({at(i), 0, PatchId{3}, ominus(said, map.poses[3])});
    }
    rows->flush();
    map.trajectory = rows;
    map.trajectory_rows = scans;
  }
  std::vector<Event> scan(std::size_t i) const {
    const bool is_blind = i == 1 || i == 2;
    const Walls walls = is_blind ? Walls{} : furnished_room();
    return {{at(i), ScanEvent{"R1", scan_from(walls, map_from_robot(i), at(i))}}};
  }
  Event odometry(std::size_t i) const {
    const Pose slipped = i > 1 ? slip : Pose{};
    return {at(i), OdometryEvent{"R1", at(i), Pose{7, 3, 2} * slipped * map_from_robot(i)}};
  }
  Pose slip;  ///< between the two in the middle, of which the engine knows
  /// By how much the two in the middle are off after these events.
  double off(const std::vector<Event>& events) const {
    Refinement refinement(map, configuration);
    for (const Event& event : events) refinement.take(event);
    EXPECT_EQ(refinement.refined(), 2U);
    const std::vector<TrajectoryRow> rows = refinement.finish()->read(0, scans);
    double most = 0;
    for (const std::size_t i : {1U, 2U})
      most = std::max(
          most, off_m(map.poses[index(rows.at(i).patch)] * rows.at(i).patch_from_robot, map_from_robot(i)));
    return most;
  }
  /// Odometry comes so much later than the scans that it was asked for.
  std::vector<Event> events(std::size_t later, std::size_t without = scans) const {
    std::vector<Event> all{robot(laser_of())};
    for (std::size_t i = 0; i < scans + later; ++i) {
      if (i < scans) all.push_back(scan(i).front());
      if (i >= later && i - later != without) all.push_back(odometry(i - later));
    }
    return all;
  }
};

TEST(Refinement, BridgesWhatShowsNothingByOdometryFromBothEnds) {
  const WithAGap gap;
  EXPECT_LT(gap.off(gap.events(0)), 0.02);
  EXPECT_LT(gap.off(gap.events(2)), 0.02) << "odometry may come after the scan";
}

TEST(Refinement, BridgesByStepsAsTheEngineHadThemWhereOdometryErredKnowingly) {
  WithAGap gap;
  gap.slip = {1, 0, 0.2};
  EXPECT_LT(gap.off(gap.events(0)), 0.02);
}

TEST(Refinement, BridgesNothingWithoutOdometryOfItsEnds) {
  const WithAGap gap;
  EXPECT_GT(gap.off({gap.robot(laser_of()), gap.scan(0).front(), gap.scan(1).front(), gap.scan(2).front(),
                     gap.scan(3).front()}),
            0.3);
  EXPECT_GT(gap.off(gap.events(0, 3)), 0.3) << "of its last scan";
}

TEST(Refinement, BridgesNothingBetweenTwoIslands) {
  WithAGap gap;
  RelationGraph apart;
  for (std::size_t i = 0; i < gap.map.patches.size(); ++i) apart.add_patch(PatchId{static_cast<int>(i)});
  for (const auto& [id, relation] : gap.map.graph.relations())
    if (relation.b != PatchId{5}) apart.add(relation);
  gap.map.graph = apart;
  auto rows = std::make_shared<TrajectoryStore>();
  for (TrajectoryRow row : gap.map.trajectory->read(0, WithAGap::scans)) {
    if (row.utime == WithAGap::at(2)) {
      row.patch_from_robot = ominus(gap.map.poses[3] * row.patch_from_robot, gap.map.poses[5]);
      row.patch = PatchId{5};
    }
    rows->append(row);
  }
  rows->flush();
  gap.map.trajectory = rows;
  EXPECT_GT(gap.off(gap.events(0)), 0.3);
}

}  // namespace
}  // namespace isthmus
