#include "scanmatch/match.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

LocalMap local_map_of(const Walls& walls, const std::vector<Pose>& views) {
  LocalMap map;
  map.reference = PatchId{0};
  for (std::size_t i = 0; i < views.size(); ++i) {
    map.patches.push_back({patch_from(walls, PatchId{static_cast<std::int32_t>(i)}, views[i]), views[i]});
  }
  return map;
}

Prediction vague(const Pose& pose) { return {pose, Eigen::Vector3d(1, 1, 1).asDiagonal()}; }

TEST(MatchScan, FindsThePoseInAFurnishedRoomFromAPredictionThatIsOff) {
  const LocalMap map = local_map_of(furnished_room(), {{-1, 0, 0.2}, {0.5, -1, 0.4}});
  const Pose truth{0.2, -0.4, 0.3};
  const auto points = to_points(scan_from(furnished_room(), truth), laser_of(), {});
  const Match match = match_scan(map, points, vague({0.32, -0.5, 0.36}), {});
  ASSERT_TRUE(match.ok);
  EXPECT_NEAR(match.local_from_robot.x, truth.x, 0.01);
  EXPECT_NEAR(match.local_from_robot.y, truth.y, 0.01);
  EXPECT_NEAR(match.local_from_robot.yaw, truth.yaw, 0.003);
  EXPECT_GT(match.quality.score, 0.8);
  EXPECT_FALSE(match.quality.degenerate);
}

// |=====================|   Walls left and right say nothing of how far along the robot is.
//      o->
// |=====================|
TEST(MatchScan, ACorridorLeavesTheDirectionAlongItToThePrediction) {
  const LocalMap map = local_map_of(corridor(), {{0, 0, 0}, {1, 0.1, 0.05}});
  const Pose truth{0.5, 0.2, 0.1};
  const auto points = to_points(scan_from(corridor(), truth), laser_of(), {});
  const Pose predicted{0.8, 0.1, 0.12};
  const Match match = match_scan(map, points, vague(predicted), {});
  ASSERT_TRUE(match.ok);
  EXPECT_NEAR(match.local_from_robot.x, predicted.x, 0.02);
  EXPECT_NEAR(match.local_from_robot.y, truth.y, 0.01);
  EXPECT_NEAR(match.local_from_robot.yaw, truth.yaw, 0.003);
  EXPECT_TRUE(match.quality.degenerate);
  EXPECT_LT(match.beam_information(0, 0), 1e-3 * match.beam_information(1, 1));
}

// A door has moved since the map was made. What few beams say is trusted little, and so pulls little:
// the pose lies between theirs and the predicted one as their information and the prediction's have it.
TEST(MatchScan, IsPulledAlongACorridorByNoMoreThanTheFewBeamsThereAreTrusted) {
  constexpr double moved_m = 0.06;
  Walls before = corridor();
  add_box(before, 3, 0.6, 3.1, 1);
  Walls after = corridor();
  add_box(after, 3 + moved_m, 0.6, 3.1 + moved_m, 1);
  const LocalMap map = local_map_of(before, {{0, 0, 0}});
  const Pose truth{0.5, 0.1, 0.05};
  const auto points = to_points(scan_from(after, truth), laser_of(), {});
  constexpr double along = 3000;  // 1/m²
  const Prediction sure{truth, Eigen::Vector3d(along, 1, 1).asDiagonal()};
  const Match match = match_scan(map, points, sure, {});
  ASSERT_TRUE(match.ok);
  // Of the root of f / √(f² + thin²), f being the few beams' share; that itself would be .10.
  EXPECT_NEAR(match.direction_trust(0, 0), 0.321, 0.03);
  const double of_beams = match.beam_information(0, 0) / (match.beam_information(0, 0) + along);
  EXPECT_NEAR(match.local_from_robot.x - truth.x, -moved_m * of_beams, 0.002);
}

TEST(MatchScan, BeginsWhereItIsToldAndIsHeldByThePredictionAllTheSame) {
  const LocalMap room = local_map_of(furnished_room(), {{-1, 0, 0.2}, {0.5, -1, 0.4}});
  const Pose truth{0.2, -0.4, 0.3};
  const auto in_room = to_points(scan_from(furnished_room(), truth), laser_of(), {});
  Prediction prediction = vague({0.2, -0.4, 1.2});
  const Match from_expected = match_scan(room, in_room, prediction, {});
  EXPECT_FALSE(from_expected.ok && std::abs(from_expected.local_from_robot.yaw - truth.yaw) < 0.1);
  prediction.start = Pose{0.25, -0.45, 0.35};
  const Match match = match_scan(room, in_room, prediction, {});
  ASSERT_TRUE(match.ok);
  EXPECT_NEAR(match.local_from_robot.yaw, truth.yaw, 0.003);

  const LocalMap hall = local_map_of(corridor(), {{0, 0, 0}, {1, 0.1, 0.05}});
  const auto in_corridor = to_points(scan_from(corridor(), {0.5, 0.2, 0.1}), laser_of(), {});
  prediction = vague({0.8, 0.1, 0.12});
  prediction.start = Pose{0.2, 0.1, 0.12};
  EXPECT_NEAR(match_scan(hall, in_corridor, prediction, {}).local_from_robot.x, 0.8, 0.02);
}

TEST(MatchScan, PeopleInFrontOfTheLaserDoNotPullThePoseAway) {
  const LocalMap map = local_map_of(furnished_room(), {{-1, 0, 0.2}, {0.5, -1, 0.4}});
  const Pose truth{0.2, -0.4, 0.3};
  Scan scan = scan_from(furnished_room(), truth);
  for (std::size_t i = 60; i < 90; ++i) scan.ranges_m[i] = 1.0F;
  const Match match = match_scan(map, to_points(scan, laser_of(), {}), vague({0.25, -0.45, 0.33}), {});
  ASSERT_TRUE(match.ok);
  EXPECT_NEAR(match.local_from_robot.x, truth.x, 0.02);
  EXPECT_NEAR(match.local_from_robot.y, truth.y, 0.02);
  EXPECT_LT(match.quality.score, 0.9);
}

TEST(MatchScan, TooFewBeamsAreNoMatchAndLeaveThePrediction) {
  const LocalMap map = local_map_of(furnished_room(), {{0, 0, 0}});
  auto points = to_points(scan_from(furnished_room(), {}), laser_of(), {});
  points.resize(5);
  const Match match = match_scan(map, points, vague({0.1, 0.1, 0}), {});
  EXPECT_FALSE(match.ok);
  EXPECT_EQ(match.local_from_robot, (Pose{0.1, 0.1, 0}));
}

TEST(MatchScan, AnEmptyLocalMapIsNoMatch) {
  const auto points = to_points(scan_from(furnished_room(), {}), laser_of(), {});
  EXPECT_FALSE(match_scan({}, points, vague({}), {}).ok);
}

TEST(MatchScan, ABeamPairedWithTwoPatchesCountsOnce) {
  const auto points = to_points(scan_from(furnished_room(), {}), laser_of(), {});
  const Match one = match_scan(local_map_of(furnished_room(), {{0, 0, 0}}), points, vague({}), {});
  const Match two = match_scan(local_map_of(furnished_room(), {{0, 0, 0}, {0, 0, 0}}), points, vague({}), {});
  EXPECT_NEAR(two.beam_information(1, 1) / one.beam_information(1, 1), 1, 0.05);
}

// Both faces of a wall of 5 cm, and a robot in either room:
//
//      A o->                     A's patch shows the lower face, B's scan sees the upper one.
//    ==========================
//      B o->
TEST(MatchScan, TheOtherFaceOfAWallIsNoPair) {
  const Walls room_a = {{{-9, 1}, {9, 1}}}, room_b = {{{-9, 1.05}, {9, 1.05}}};
  const LocalMap map = local_map_of(room_a, {{0, 2, 0}});
  const auto same_side = to_points(scan_from(room_a, {0.2, 2.5, 0}), laser_of(), {});
  const auto other_side = to_points(scan_from(room_b, {0.2, 0, 0}), laser_of(), {});
  ASSERT_TRUE(match_scan(map, same_side, vague({0.2, 2.5, 0}), {}).ok);
  const Match match = match_scan(map, other_side, vague({0.2, 0, 0}), {});
  EXPECT_FALSE(match.ok);
  EXPECT_TRUE(match.pairs.empty());
  EXPECT_EQ(match.local_from_robot, (Pose{0.2, 0, 0}));
}

// Of the patch's points near a beam's end, those are paired whose noise has brought them there: more so on
// the near wall, where they lie close together, and more so here than farther on.
//
//    =======================   1.4 m
//
//      o->   o->
//    =======================   0.6 m
TEST(MatchScan, NoiseTurnsAMatchBetweenWallsAtUnlikeDistancesNoMoreOneWayThanTheOther) {
  constexpr int trials = 500;
  std::mt19937 engine(1);
  const Pose from{0, -0.4, 0}, to{0.2, -0.4, 0};
  double yaw_rad = 0, aside_m = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Scan before = with_noise(scan_from(corridor(), from), 0.03, engine);
    const Scan after = with_noise(scan_from(corridor(), to), 0.03, engine);
    const LocalMap map{PatchId{0}, {{make_patch(PatchId{0}, "R1", before, laser_of(), {}), from}}};
    const Match match = match_scan(map, to_points(after, laser_of(), {}), vague(to), {});
    ASSERT_TRUE(match.ok);
    yaw_rad += match.local_from_robot.yaw / trials;
    aside_m += (match.local_from_robot.y - to.y) / trials;
  }
  EXPECT_NEAR(yaw_rad, 0, 3e-4);
  EXPECT_NEAR(aside_m, 0, 8e-4);
}

// The patch saw a piece of wall half a metre long, and the scan sees on beyond both its ends.
TEST(MatchScan, ALineSaysLessAsideOfItsPoints) {
  const Walls piece = {{{-0.25, 1}, {0.25, 1}}}, wall = {{{-1, 1}, {1, 1}}};
  const LocalMap map = local_map_of(piece, {{0, 0, 0}});
  const auto points = to_points(scan_from(wall, {}), laser_of(), {});
  const Match match = match_scan(map, points, vague({}), {});
  ASSERT_TRUE(match.ok);
  double inside = 1, beyond = 1;
  for (const Pair& pair : match.pairs) {
    const double x = std::abs(points[static_cast<std::size_t>(pair.point)].position.x());
    if (x < 0.2) inside = std::min(inside, pair.weight);
    if (x > 0.45) beyond = std::min(beyond, pair.weight);
  }
  EXPECT_GT(inside, 0.95);
  EXPECT_LT(beyond, 0.6);
  EXPECT_GT(beyond, 0.1);
}

// A quarter of what the scan sees ahead has moved by 10 cm since: it pairs with the old place, and would pull
// the pose there by centimetres.
TEST(MatchScan, WhatStandsAsideOfItsLineHasNextToNoWeight) {
  const LocalMap map = local_map_of(furnished_room(), {{-1, 0, 0.2}});
  const Pose truth{-0.8, -0.1, 0.1};
  Scan scan = scan_from(furnished_room(), truth);
  int moved = 0;
  for (std::size_t i = 70; i < 110; i += 2, ++moved) scan.ranges_m[i] -= 0.1F;
  ASSERT_EQ(moved, 20);
  const Match match = match_scan(map, to_points(scan, laser_of(), {}), vague(truth), {});
  ASSERT_TRUE(match.ok);
  EXPECT_NEAR(match.local_from_robot.x, truth.x, 0.01);
  EXPECT_NEAR(match.local_from_robot.y, truth.y, 0.01);
  double moved_weight = 0;
  for (const Pair& pair : match.pairs)
    if (pair.point >= 70 && pair.point < 110 && pair.point % 2 == 0) moved_weight += pair.weight;
  EXPECT_LT(moved_weight, 0.1 * moved);
}

// Both lasers see the same room; how well a scan fits is told besides its laser's noise, and what it says of
// the pose is the less.
TEST(MatchScan, AScanOfANoisyLaserFitsAsWellAndSaysLess) {
  const LocalMap map = local_map_of(furnished_room(), {{-1, 0, 0.2}});
  const Pose truth{-0.8, -0.1, 0.1};
  std::mt19937 engine(1);
  const auto fine = to_points(with_noise(scan_from(furnished_room(), truth), 0.01, engine), laser_of(), {});
  const auto coarse = to_points(with_noise(scan_from(furnished_room(), truth), 0.08, engine), laser_of(), {});
  auto taken_as_fine = coarse;
  for (ScanPoint& point : taken_as_fine) point.noise_m2 = fine.front().noise_m2;
  const Match of_fine = match_scan(map, fine, vague(truth), {});
  const Match of_coarse = match_scan(map, coarse, vague(truth), {});
  const Match mistaken = match_scan(map, taken_as_fine, vague(truth), {});
  ASSERT_TRUE(of_fine.ok && of_coarse.ok && mistaken.ok);
  EXPECT_GT(of_coarse.quality.score, 0.5);
  EXPECT_GT(of_coarse.quality.score, mistaken.quality.score + 0.15);
  EXPECT_LT(of_coarse.beam_information(2, 2), 0.5 * of_fine.beam_information(2, 2));
}
}  // namespace
}  // namespace isthmus
