#include "server/engine/localise/mapper.hpp"

#include <gtest/gtest.h>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A robot in a room, driven by hand; it scans ten times a second.
struct Driven {
  Driven() {
    robot.declaration.robot = "R1";
    robot.declaration.laser = laser_of();
  }
  // It stands at `truth` and its odometry says `odometry`.
  ScanOutcome scan(const Pose& truth, const Pose& odometry, const Walls& walls) {
    utime += 100'000;
    return take_scan(map, robot, observe(scan_from(walls, truth, utime), laser_of(), options.patch), odometry,
                     options);
  }
  ScanOutcome scan(const Pose& truth) { return scan(truth, truth, furnished_room()); }
  // Blind: nothing is in its laser's reach.
  ScanOutcome blind_scan(const Pose& odometry) { return scan({}, odometry, {}); }

  EngineOptions options;
  Map map;
  Robot robot;
  std::int64_t utime = 0;
};

TEST(TakeScan, BeginsAnIslandWithTheFirst) {
  Driven driven;
  const ScanOutcome first = driven.scan({0.5, 0, 0});
  EXPECT_TRUE(first.new_session);
  EXPECT_EQ(driven.map.manifold().size(), 1U);
  EXPECT_EQ(first.pose.pose.patch, PatchId{0});
  EXPECT_EQ(first.pose.map_from_robot, Pose{});
  EXPECT_TRUE(first.pose.matched);
}

TEST(TakeScan, LocalisesOnKnownGroundAndDiscardsTheScan) {
  Driven driven;
  driven.scan({});
  const ScanOutcome second = driven.scan({0.2, 0.1, 0.05}, {0.22, 0.09, 0.06}, furnished_room());
  EXPECT_FALSE(second.new_session);
  EXPECT_EQ(second.unmatched, Unmatched::no) << word(second.unmatched);
  EXPECT_NEAR(second.pose.map_from_robot.x, 0.2, 0.01);
  EXPECT_NEAR(second.pose.map_from_robot.y, 0.1, 0.01);
  EXPECT_NEAR(second.pose.map_from_robot.yaw, 0.05, 0.005);
  EXPECT_EQ(second.pose.utime, driven.utime);
  EXPECT_EQ(driven.map.manifold().size(), 1U);
}

TEST(TakeScan, ExtendsTheMapByTheWay) {
  Driven driven;
  for (int i = 0; i <= 7; ++i) driven.scan({0.15 * i, 0, 0});
  ASSERT_EQ(driven.map.manifold().size(), 2U);
  EXPECT_NEAR(driven.map.manifold().pose(PatchId{1}).x, 1.05, 0.02) << "a metre and a bit on";
  EXPECT_EQ(driven.robot.place->pose.patch, PatchId{1});
  EXPECT_EQ(driven.map.graph().islands().size(), 1U);
}

TEST(TakeScan, RefusesAPatchBeyondThoseThatARobotMayHave) {
  Driven driven;
  driven.options.patches_per_robot = 1;
  EXPECT_FALSE(may_not_begin(driven.robot, driven.options));
  EXPECT_FALSE(driven.scan({}).patch_refused);
  EXPECT_TRUE(has_all_patches(driven.robot, driven.options));
  for (int i = 1; i <= 10; ++i) EXPECT_FALSE(driven.scan({0.1 * i - 0.05, 0, 0}).patch_refused);
  const ScanOutcome far = driven.scan({1.1, 0, 0});
  EXPECT_TRUE(far.patch_refused);
  EXPECT_EQ(far.unmatched, Unmatched::no) << "it is localised all the same";
  EXPECT_EQ(driven.map.manifold().size(), 1U);
  driven.robot.place.reset();
  EXPECT_TRUE(may_not_begin(driven.robot, driven.options)) << "it would need a patch";
}

// Where nothing matches, nor one scan the other, odometry alone carries the map on.
TEST(TakeScan, ExtendsTheMapByOdometryOnceItsSurroundingsAreLeftBehind) {
  Driven driven;
  driven.scan({});
  const Walls wedge{{{-5, -0.7}, {5, -0.3}}, {{-5, 0.5}, {5, 1.6}}};
  EXPECT_NE(driven.scan({}, {0.1, 0, 0}, box(0.9)).unmatched, Unmatched::no);
  driven.scan({}, {0.3, 0, 0}, wedge);
  EXPECT_EQ(driven.map.manifold().size(), 1U);
  driven.scan({}, {0.5, 0, 0}, box(0.7));
  ASSERT_EQ(driven.map.manifold().size(), 2U);
  EXPECT_NEAR(driven.map.manifold().pose(PatchId{1}).x, 0.5, 1e-6);
  EXPECT_EQ(driven.map.graph().relations().size(), 1U);
}

TEST(TakeScan, MakesNoPatchOfAScanThatSawNothing) {
  Driven driven;
  driven.scan({});
  for (int i = 1; i < 10; ++i)
    EXPECT_EQ(driven.blind_scan({0.3 * i, 0, 0}).unmatched, Unmatched::few_returns);
  EXPECT_EQ(driven.map.manifold().size(), 1U);
  EXPECT_NEAR(driven.robot.place->pose.patch_from_object.x, 2.7, 1e-9);
}

// After metres that it saw nothing of, a robot sees the room that it came from, or one like it: which, no
// single scan tells. Its ground there is its own, as far as odometry goes.
TEST(TakeScan, BelievesNoSingleScanOfARobotThatHasLostItsWay) {
  for (const int blind : {6, 60}) {
    Driven driven;
    driven.scan({});
    const double end_m = blind > 6 ? 0.6 : 0;
    for (int i = 1; i <= blind; ++i)
      driven.blind_scan({std::min(0.15 * i, 0.15 * (blind - i) + end_m), 0, 0});
    const Pose odometry{end_m, 0, 0}, truth{end_m + 0.3, 0, 0};
    const ScanOutcome found = driven.scan(truth, odometry, furnished_room());
    const bool lost = blind > 6;
    EXPECT_EQ(found.unmatched == Unmatched::no, !lost) << word(found.unmatched);
    EXPECT_NEAR(found.pose.map_from_robot.x, lost ? odometry.x : truth.x, 0.05);
    EXPECT_EQ(driven.map.manifold().size(), lost ? 2U : 1U);
    EXPECT_TRUE(driven.scan(truth, odometry, furnished_room()).pose.matched)
        << "on its own ground, or the old";
    EXPECT_EQ(driven.map.graph().islands().size(), 1U);
  }
}

TEST(TakeScan, ARobotThatMayHaveNoMorePatchesIsFoundOnThoseThatItHas) {
  Driven driven;
  driven.options.patches_per_robot = 1;
  driven.scan({});
  for (int i = 1; i <= 60; ++i) driven.blind_scan({0.15 * std::min(i, 60 - i), 0, 0});
  EXPECT_TRUE(driven.scan({0.3, 0, 0}, {}, furnished_room()).pose.matched);
}

// Odometry tells half of a turn on the spot, and three scans see nothing.
TEST(TakeScan, WhereNothingMatchesTurnsAreToldAsWronglyAsBefore) {
  Driven driven;
  for (int i = 0; i <= 6; ++i) driven.scan({0, 0, 0.2 * i}, {0, 0, 0.1 * i}, furnished_room());
  ASSERT_NEAR(driven.map.relative_pose(PatchId{0}, driven.robot.place->pose.patch).yaw +
                  driven.robot.place->pose.patch_from_object.yaw,
              1.2, 0.02);
  ScanOutcome lost;
  for (int i = 7; i <= 9; ++i) lost = driven.blind_scan({0, 0, 0.1 * i});
  EXPECT_FALSE(lost.pose.matched);
  EXPECT_NEAR(lost.pose.map_from_robot.yaw, 1.8, 0.06);
}

// Carried away: odometry jumps, and what the robot sees fits nowhere near.
TEST(TakeScan, BeginsAnotherIslandWhereOdometryJumpedAndNothingFitsForLong) {
  Driven driven;
  driven.scan({});
  Walls hall;
  add_box(hall, -0.9, -0.9, 1.1, 0.8);
  for (int i = 0; i < 7; ++i) {
    const ScanOutcome lost = driven.scan({}, {30, 0, 0}, hall);
    EXPECT_TRUE(lost.unplaced);
    EXPECT_FALSE(lost.new_session);
  }
  EXPECT_TRUE(driven.scan({}, {30, 0, 0}, hall).new_session);
  EXPECT_EQ(driven.map.graph().islands().size(), 2U);
}

TEST(TakeScan, ForgivesAJumpOnceAScanFits) {
  Driven driven;
  driven.scan({});
  Walls hall;
  add_box(hall, -0.9, -0.9, 1.1, 0.8);
  for (int i = 0; i < 5; ++i) driven.scan({}, {30, 0, 0}, hall);
  const ScanOutcome found = driven.scan({0.5, 0, 0}, {30.5, 0, 0}, furnished_room());
  EXPECT_EQ(found.unmatched, Unmatched::no) << word(found.unmatched);
  EXPECT_FALSE(found.unplaced);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(driven.scan({}, {30.5, 0, 0}, hall).new_session);
  EXPECT_EQ(driven.map.graph().islands().size(), 1U);
}

// It turns within a scan as fast as robots do, and its odometry hears of it later: no layer of the room is
// added at a slant.
TEST(TakeScan, FindsTheHeadingOfATurnThatOdometryMissed) {
  Driven driven;
  for (int i = 0; i < 3; ++i) driven.scan({});
  driven.utime += 100'000;
  const ScanOutcome turned = driven.scan({0, 0, 0.65}, {}, furnished_room());
  EXPECT_TRUE(turned.pose.matched);
  EXPECT_NEAR(turned.pose.map_from_robot.yaw, 0.65, 0.01);
  EXPECT_NEAR(driven.scan({0, 0, 0.65}, {0, 0, 0.6}, furnished_room()).pose.map_from_robot.yaw, 0.65, 0.01)
      << "nor when it hears of it";
}

// It comes round a corner as its odometry freezes: of what it sees there no patch has seen anything. Scan by
// scan it knows its turn all the same.
TEST(TakeScan, GoesRoundACornerByWhatEachScanShowsOfTheOneBefore) {
  Driven driven;
  driven.scan({});
  Walls round_the_corner;
  add_box(round_the_corner, -0.9, -0.9, 1.1, 0.8);
  for (int i = 0; i <= 2; ++i) {
    const ScanOutcome lost = driven.scan({0, 0, 0.25 * i}, {}, round_the_corner);
    EXPECT_FALSE(lost.pose.matched);
    EXPECT_NEAR(lost.pose.map_from_robot.yaw, 0.25 * i, 0.02);
  }
  EXPECT_EQ(driven.robot.place->lost_scans, 3);
  EXPECT_EQ(driven.robot.place->unseen_steps, 1);
}

// Beside a wall that the map does not have it sees walls that would fit a good way off. Its odometry, and
// what it saw a moment before, say that it is where it was.
TEST(TakeScan, BelievesWhatItSawAMomentBeforeRatherThanADoubtfulFitElsewhere) {
  Driven driven;
  driven.options.localise.common.doubtful_score = 0.95;
  driven.scan({});
  Walls moved{{{-3, 1}, {3, 1}}, {{1, 1}, {1, 0.7}}, {{-1, 1}, {-1, 0.6}}, {{-0.3, 1}, {-0.3, 0.8}}};
  EXPECT_FALSE(driven.scan({}, {}, moved).pose.matched);
  for (Wall2d wall : furnished_room()) {
    if (wall.first.y() > 0 && wall.second.y() > 0) continue;
    wall.first += Eigen::Vector2d(0.5, -0.2);
    wall.second += Eigen::Vector2d(0.5, -0.2);
    moved.push_back(wall);
  }
  const ScanOutcome beside = driven.scan({}, {}, moved);
  EXPECT_FALSE(beside.pose.matched);
  EXPECT_NEAR(beside.pose.map_from_robot.x, 0, 0.02);
  EXPECT_NEAR(beside.pose.map_from_robot.y, 0, 0.02);
}

// A desk was put there: what is seen now fits worse than before, and nowhere better.
TEST(TakeScan, KeepsAPoorMatchWhereNoneIsClearlyBetter) {
  Driven driven;
  driven.scan({});
  Walls changed = furnished_room();
  for (double x = -2; x < 3; x += 0.8) add_box(changed, x, 0.8, x + 0.5, 1.3);
  const ScanOutcome second = driven.scan({0.1, 0, 0}, {0.1, 0, 0}, changed);
  EXPECT_TRUE(second.pose.matched);
  EXPECT_NEAR(second.pose.map_from_robot.x, 0.1, 0.03);
  EXPECT_NEAR(second.pose.map_from_robot.yaw, 0, 0.02);
}

}  // namespace
}  // namespace isthmus
