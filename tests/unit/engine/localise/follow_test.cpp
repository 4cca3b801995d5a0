#include "server/engine/localise/follow.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/engine/robot/robot_pose.hpp"
#include "tests/support/poses.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A robot on patch 0, and patches whose poses are known to a millimetre, all in one room.
struct OnPatches {
  explicit OnPatches(const std::vector<Pose>& world_from_patches) {
    add_way(map, furnished_room(), world_from_patches);
    robot.place = Localisation{};
    robot.place->pose = {PatchId{0}, {}};
    robot.place->last_patch = PatchId{0};
    choose({});
  }
  void choose(const Pose& local_from_robot) {
    choose_local_map(map, robot, local_from_robot, map.manifold().patch(PatchId{0}).points, options);
  }
  // A scan that was matched there.
  void follow_to(const Pose& local_from_robot, bool matched = true, bool plausible = true,
                 const Pose& odometry_step = {}) {
    Expectation expectation;
    expectation.step = plausible ? odometry_step : Pose{};
    expectation.claimed_step = odometry_step;
    expectation.plausible = plausible;
    expectation.step_covariance = robot.noise.covariance(expectation.step, {});
    Placement placement;
    placement.matched = matched;
    placement.local_from_robot = local_from_robot;
    placement.match = match;
    placement.covariance = Eigen::Vector3d(1, 4, 9).asDiagonal();
    placement.tracking_covariance = Eigen::Vector3d(2, 8, 18).asDiagonal();
    follow(map, robot, expectation, placement, {7, 8, 0.5}, utime, {});
  }
  const ManifoldPose& pose() const { return robot.place->pose; }

  EngineOptions options;
  Map map;
  Robot robot;
  Match match;  ///< of the next scan
  std::int64_t utime = 5'000'000;
};

// A scan that fits nowhere: its step is known by the one before it, or by odometry alone.
TEST(MoveOn, LearnsFromAStepThatTwoScansShowWhatOdometryMissed) {
  for (const bool seen : {true, false}) {
    OnPatches on({{0, 0, 0}});
    Expectation expectation;
    expectation.seen = seen;
    expectation.step = {0.01, 0, 0.3};
    expectation.step_covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
    for (int i = 0; i < 3; ++i) {
      Placement placement;
      placement.local_from_robot = on.robot.place->pose.patch_from_object * expectation.step;
      move_on(on.robot, expectation, placement, {}, on.utime += 200'000, {});
      on.robot.place->pose.patch_from_object = placement.local_from_robot;
    }
    EXPECT_EQ(on.robot.turn_error.expected_rad() > 0.2, seen);
    EXPECT_NEAR(on.robot.place->untold.yaw, seen ? 0.9 : 0, 1e-9) << "odometry may tell it yet";
    EXPECT_EQ(on.robot.place->lost_scans, 3) << "of the map";
  }
}

// A robot sets off, and its scans are .3 s late.
TEST(MoveOn, TakesLateScansForNoWayThatOdometryCountsTooLong) {
  OnPatches on({{0, 0, 0}});
  const auto odometry_x = [](double s) {
    return s < 0.6 ? 0.25 / 0.6 * s * std::max(0.0, s) : 0.5 * s - 0.15;
  };
  for (int i = -10; i < 30; ++i) on.robot.odometry.add(i * 50'000, {odometry_x(0.05 * i), 0, 0});
  on.robot.place->utime = 0;
  for (double s = 0.2; s < 1.3; s += 0.2) {
    const auto step_at = [&](double at_s) { return Pose{odometry_x(at_s) - odometry_x(at_s - 0.2), 0, 0}; };
    Expectation expectation;
    expectation.step = expectation.claimed_step = step_at(s);
    expectation.step_covariance = 1e-4 * Eigen::Matrix3d::Identity();
    Placement placement;
    placement.matched = true;
    placement.local_from_robot = on.robot.place->pose.patch_from_object * step_at(s - 0.3);
    placement.match.direction_trust = Eigen::Matrix2d::Identity();
    placement.covariance = placement.tracking_covariance = 1e-4 * Eigen::Matrix3d::Identity();
    move_on(on.robot, expectation, placement, {}, std::llround(1e6 * s), {});
    on.robot.place->pose.patch_from_object = placement.local_from_robot;
  }
  EXPECT_NEAR(on.robot.bias.way_share(), 0, 0.015);
}

// What scans showed of a step was right, and odometry was not.
TEST(MoveOn, LearnsHowFarOdometryErrsNotTheStepThatScansShow) {
  OnPatches on({{0, 0, 0}});
  const double scale_before = on.robot.noise.translation_scale();
  Expectation expectation;
  expectation.seen = true;
  expectation.claimed_step = {0.1, 0, 0};
  expectation.step = {0.2, 0, 0};
  expectation.step_covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
  for (int i = 0; i < 20; ++i) {
    Placement placement;
    placement.matched = true;
    placement.local_from_robot = expectation.step;
    placement.covariance = placement.tracking_covariance = 1e-4 * Eigen::Matrix3d::Identity();
    move_on(on.robot, expectation, placement, {}, on.utime += 200'000, {});
  }
  EXPECT_GT(on.robot.noise.translation_scale(), scale_before);
}

// Eq. 14: the nearest patch, and r = π* ⊖ π in its frame.
TEST(Follow, PutsTheRobotOnTheNearestPatch) {
  OnPatches on({{0, 0, 0}, {2, 0.5, quarter_turn}});
  on.follow_to({1.8, 0.5, 0.3});
  EXPECT_EQ(on.pose().patch, PatchId{1});
  expect_near(on.pose().patch_from_object, {0, 0.2, 0.3 - quarter_turn});
}

TEST(Follow, TurnsTheCovarianceIntoTheFrameOfThePatch) {
  OnPatches on({{0, 0, 0}, {2, 0.5, quarter_turn}});
  on.follow_to({1.8, 0.5, 0.3});
  EXPECT_TRUE(
      on.robot.place->covariance.isApprox(Eigen::Matrix3d(Eigen::Vector3d(4, 1, 9).asDiagonal()), 1e-9));
  EXPECT_TRUE(on.robot.place->tracking_covariance.isApprox(
      Eigen::Matrix3d(Eigen::Vector3d(8, 2, 18).asDiagonal()), 1e-9));
}

TEST(Follow, KeepsThePatchUntilAnotherIsClearlyNearer) {
  OnPatches on({{0, 0, 0}, {2, 0, 2 * quarter_turn}});
  on.follow_to({1.09, 0, 0});
  EXPECT_EQ(on.pose().patch, PatchId{0});
  expect_near(on.pose().patch_from_object, {1.09, 0, 0});
  on.follow_to({1.11, 0, 0});
  EXPECT_EQ(on.pose().patch, PatchId{1});
}

// Eq. 14 asks of those patches only whose polygons the robot lies in.
TEST(Follow, PutsTheRobotOnNoPatchThatItDoesNotLieIn) {
  OnPatches facing_away({{0, 0, 0}, {2, 0, 0}});
  facing_away.follow_to({1.3, 0, 0});
  EXPECT_EQ(facing_away.pose().patch, PatchId{0}) << "a patch sees nothing behind itself";
  OnPatches facing_it({{0, 0, 0}, {2, 0, 2 * quarter_turn}});
  facing_it.follow_to({1.3, 0, 0});
  EXPECT_EQ(facing_it.pose().patch, PatchId{1});
}

// Two layers of one place, as before a loop is closed: the robot stays on the one that its scan was matched
// with, however near the other is.
TEST(Follow, PutsTheRobotOnNoPatchThatItsScanDoesNotMatch) {
  for (const bool fits_both : {false, true}) {
    OnPatches on({{0, 0, 0}, {2, 0, 2 * quarter_turn}});
    on.robot.local_map = {PatchId{0}, {}};
    for (const PatchId id : {PatchId{0}, PatchId{1}})
      on.robot.local_map.patches.push_back(
          {on.map.manifold().shared_patch(id), on.map.relative_pose(PatchId{0}, id)});
    for (int point = 0; point < 20; ++point) {
      on.match.pairs.push_back({0, point, point, 1.0});
      if (fits_both || point < 3) on.match.pairs.push_back({1, point, point, 1.0});
    }
    on.follow_to({1.8, 0, 0});
    EXPECT_EQ(on.pose().patch, PatchId{fits_both ? 1 : 0});
  }
}

// Only patches of the local map count: of others nobody knows how near they are.
TEST(Follow, PutsTheRobotOnNoPatchThatIsLooselyDetermined) {
  OnPatches on({{0, 0, 0}});
  const PatchId loose = on.map.manifold().next_id();
  on.map.add(patch_from(furnished_room(), loose, {2, 0, 0}), {2, 0, 0});
  on.map.relate(odometry_relation(PatchId{0}, loose, {2, 0, 0}, {1, 1, 100}));
  on.choose({});
  on.follow_to({2, 0, 0});
  EXPECT_EQ(on.pose().patch, PatchId{0});
}

TEST(Follow, RemembersTheScan) {
  OnPatches on({{0, 0, 0}});
  on.robot.place->suspect = true;
  on.robot.place->lost_scans = 3;
  Eigen::Matrix3d expected = on.robot.noise.covariance({0.45, 0, 0.08}, {});
  const double told_rad2 = expected(2, 2);
  expected(2, 2) = 18;
  on.follow_to({0.5, 0, 0.1}, true, true, {0.45, 0, 0.08});
  const Localisation& place = *on.robot.place;
  EXPECT_EQ(place.utime, 5'000'000);
  expect_near(place.odom_from_robot, {7, 8, 0.5});
  expect_near(place.last_step, {0.5, 0, 0.1});
  expect_near(place.since_last_patch.start_from_end, {0.45, 0, 0.1});
  EXPECT_TRUE(place.since_last_patch.covariance.isApprox(expected, 1e-6))
      << "turned as surely as the scan says";
  EXPECT_NEAR(place.told_since_last_patch.rad, 0.08, 1e-9);
  EXPECT_NEAR(place.told_since_last_patch.variance_rad2, told_rad2, 1e-12);
  EXPECT_FALSE(place.suspect);
  EXPECT_EQ(place.lost_scans, 0);
}

TEST(Follow, LearnsHowScansFitWhereOdometryLeavesNoDoubt) {
  OnPatches on({{0, 0, 0}});
  on.match.quality.score = 0.9;
  const auto least_score = [&] { return on.robot.usual_misfit.least_score({}); };
  const double at_first = least_score();
  on.follow_to({}, false);
  on.follow_to({}, true, false);
  EXPECT_EQ(least_score(), at_first) << "not matched, or after a jump";
  on.robot.place->suspect = true;
  on.follow_to({});
  EXPECT_EQ(least_score(), at_first) << "the first after a jump";
  on.follow_to({});
  EXPECT_GT(least_score(), at_first);
}

TEST(Follow, CountsScansThatWereNotMatched) {
  OnPatches on({{0, 0, 0}});
  on.follow_to({0.1, 0, 0.1}, false, true, {0.1, 0, 0});
  on.follow_to({0.2, 0, 0}, false, true, {0.1, 0, 0});
  EXPECT_EQ(on.robot.place->lost_scans, 2);
  EXPECT_FALSE(on.robot.place->suspect);
  on.follow_to({0.2, 0, 0}, false, false, {9, 0, 0});
  EXPECT_TRUE(on.robot.place->suspect) << "odometry did what no robot does";
  on.follow_to({0.3, 0, 0}, false, true, {0.1, 0, 0});
  EXPECT_TRUE(on.robot.place->suspect) << "until a scan is matched";
  EXPECT_NEAR(on.robot.place->since_last_patch.start_from_end.x, 0.3, 1e-9) << "a jump is no way";
  EXPECT_EQ(on.robot.place->since_last_patch.start_from_end.yaw, 0) << "nothing has shown a turn";
}

// Odometry that says too little, as matching tells again and again, is trusted less.
TEST(Follow, LearnsHowFarOdometryIsRight) {
  OnPatches on({{0, 0, 0}});
  const double before = on.robot.noise.translation_scale();
  on.follow_to({0.5, 0, 0}, true, false, {0.1, 0, 0});
  EXPECT_EQ(on.robot.noise.translation_scale(), before) << "of an implausible step nothing is learned";
  on.robot.place->pose.patch_from_object = {};
  on.follow_to({0.5, 0, 0}, false, true, {0.1, 0, 0});
  EXPECT_EQ(on.robot.noise.translation_scale(), before) << "nor of a scan that was not matched";
  on.robot.place->pose.patch_from_object = {};
  on.follow_to({0.5, 0, 0}, true, true, {0.1, 0, 0});
  EXPECT_GT(on.robot.noise.translation_scale(), before);
}

// A robot that turns to and fro on the spot, and whose scans are stamped so late.
TEST(Follow, LearnsWhichMomentOfOdometryAScanIsOf) {
  OnPatches on({{0, 0, 0}});
  const auto yaw_at = [](double seconds) { return 0.5 * std::sin(0.7 * seconds); };
  const auto delay_after = [&](double late_s, bool plausible) {
    on.robot.odometry.clear();
    on.robot.scan_delay = {};
    for (int i = 1; i < 200; ++i) {
      const double seconds = 0.2 * i;
      for (int k = 0; k < 4; ++k)
        on.robot.odometry.add(200'000 * i + 50'000 * k, {0, 0, yaw_at(seconds + 0.05 * k)});
      on.utime = 200'000 * i;
      on.follow_to({0, 0, yaw_at(seconds - late_s)}, true, plausible,
                   {0, 0, yaw_at(seconds) - yaw_at(seconds - 0.2)});
    }
    return on.robot.odometry.newest_utime() - on.robot.odometry.newest_own_utime();
  };
  EXPECT_NEAR(static_cast<double>(delay_after(0.3, true)), 300'000, 15'000);
  EXPECT_EQ(on.robot.place->odom_from_robot, on.robot.odometry.at(on.utime)) << "the next step begins there";
  on.robot.odometry.set_delay_of_others(0);
  EXPECT_EQ(delay_after(0.3, false), 0) << "of implausible odometry nothing is learned";
  EXPECT_EQ(delay_after(-0.3, true), 0) << "a scan does not wait for what odometry has yet to tell";
  EXPECT_LT(on.robot.scan_delay.us(), -200'000) << "but the report says so";
}

std::vector<int> patches_in(const LocalMap& local_map) {
  std::vector<int> ids;
  for (const LocalPatch& local : local_map.patches) ids.push_back(local.patch->id.value);
  return ids;
}

TEST(ChooseLocalMap, TakesThePatchesAroundTheRobot) {
  const OnPatches on({{0, 0, 0}, {0.5, 0, 0}});
  EXPECT_EQ(on.robot.local_map.reference, PatchId{0});
  EXPECT_EQ(patches_in(on.robot.local_map), (std::vector<int>{0, 1}));
  expect_near(on.robot.local_map.patches.at(1).local_from_patch, {0.5, 0, 0});
}

TEST(ChooseLocalMap, KeepsItUntilTheRobotHasMovedOrTurned) {
  OnPatches on({{0, 0, 0}});
  on.choose({0.39, 0, 0});
  expect_near(on.robot.local_map_centre, {});
  on.choose({0, 0.41, 0});
  expect_near(on.robot.local_map_centre, {0, 0.41, 0});
  on.choose({0, 0.41, 0.31});
  expect_near(on.robot.local_map_centre, {0, 0.41, 0.31});
}

TEST(ChooseLocalMap, ChoosesAnewWhereTheMapHasChanged) {
  OnPatches on({{0, 0, 0}});
  const PatchId next = on.map.manifold().next_id();
  on.map.add(patch_from(furnished_room(), next, {0.5, 0, 0}), {0.5, 0, 0});
  on.map.relate(odometry_relation(PatchId{0}, next, {0.5, 0, 0}));
  on.choose({});
  EXPECT_EQ(patches_in(on.robot.local_map), (std::vector<int>{0, 1}));
}

TEST(Answer, ProjectsTheRobotOnThePlaneOfItsIsland) {
  OnPatches on({{1, 2, quarter_turn}, {1, 3, quarter_turn}});
  on.robot.declaration.robot = "R1";
  on.robot.place->pose = {PatchId{1}, {0.5, 0, 0}};
  on.robot.place->odom_from_robot = {7, 8, 0};
  on.robot.place->utime = 3;
  on.robot.place->covariance = Eigen::Vector3d(1, 4, 9).asDiagonal();
  const RobotPose pose = answer(on.map, on.robot, true);
  EXPECT_EQ(pose.robot, "R1");
  EXPECT_EQ(pose.utime, 3);
  EXPECT_EQ(pose.island, PatchId{0});
  EXPECT_EQ(pose.pose.patch, PatchId{1});
  EXPECT_EQ(pose.covariance, on.robot.place->covariance);
  expect_near(pose.map_from_robot, {1, 3.5, quarter_turn});
  expect_near(pose.map_from_odom * Pose{7, 8, 0}, {1, 3.5, quarter_turn});
  EXPECT_TRUE(pose.matched);
  EXPECT_FALSE(answer(on.map, on.robot, false).matched);
}

TEST(Expect, OfARobotWhoseOdometryStandsStillAfterItDroveIsAsWideAsItMayHaveGoneOn) {
  Robot robot;
  robot.place = Localisation{};
  robot.place->covariance = robot.place->tracking_covariance = Eigen::Matrix3d::Zero();
  robot.place->last_step = robot.place->last_told = {0.2, 0, 0};
  const Expectation frozen = expect(robot, {}, 200'000, {});
  EXPECT_NEAR(std::sqrt(frozen.covariance(0, 0)), 0.1, 0.01) << "of a quarter that it goes on";
  EXPECT_LT(frozen.covariance(1, 1), 1e-4) << "along its way alone";
  EXPECT_EQ(frozen.covariance, frozen.step_covariance);
  robot.place->last_step = {0.6, 0, 0};
  EXPECT_EQ(expect(robot, {}, 200'000, {}).covariance, frozen.covariance) << "no faster than it drove before";
  robot.place->last_step = {0.2, 0, 0};
  const Expectation drives = expect(robot, {0.2, 0, 0}, 200'000, {});
  EXPECT_LT(drives.covariance(0, 0), 1e-3);
  robot.place->last_step = {};
  EXPECT_LT(expect(robot, {}, 200'000, {}).covariance(0, 0), 1e-4);
}

}  // namespace
}  // namespace isthmus
