#include "patches/scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <random>

#include "tests/support/patch_scenes.hpp"

namespace isthmus {
namespace {

using testing::half_turn;
using testing::infinite_range;
using testing::look_at;
using testing::nan_range;
using testing::reversed;

TEST(Scan, RangesAreClassifiedByRep117) {
  Laser laser;
  laser.range_min_m = 0.5;
  laser.range_max_m = 10;
  EXPECT_EQ(classify(5, laser), BeamKind::hit);
  EXPECT_EQ(classify(0.5F, laser), BeamKind::hit);
  EXPECT_EQ(classify(9.99F, laser), BeamKind::hit);
  EXPECT_EQ(classify(10, laser), BeamKind::no_return);
  EXPECT_EQ(classify(11, laser), BeamKind::no_return);
  EXPECT_EQ(classify(infinite_range, laser), BeamKind::no_return);
  for (const float range_m : {0.49F, 0.0F, -0.0F, -5.0F, -infinite_range, nan_range}) {
    EXPECT_EQ(classify(range_m, laser), BeamKind::ignored) << range_m;
  }
}

TEST(Scan, ZeroRangeIsIgnoredEvenWithoutAMinimum) {
  Laser laser;
  laser.range_min_m = 0;
  EXPECT_EQ(classify(0, laser), BeamKind::ignored);
  EXPECT_EQ(classify(1e-3F, laser), BeamKind::hit);
}

TEST(Scan, InfinityIsNoReturnAlsoForALaserWithoutAMaximum) {
  Laser laser;
  laser.range_max_m = std::numeric_limits<double>::infinity();
  EXPECT_EQ(classify(infinite_range, laser), BeamKind::no_return);
  EXPECT_EQ(classify(1e6F, laser), BeamKind::hit);
}

TEST(Scan, ALargestRangeThatNoFloatIsIsNoReturnToo) {
  Laser laser;
  laser.range_max_m = 5.6;
  ASSERT_LT(5.6F, laser.range_max_m);
  EXPECT_EQ(classify(5.6F, laser), BeamKind::no_return);
  EXPECT_EQ(classify(5.59F, laser), BeamKind::hit);
}

TEST(Scan, PointsAreTheHitsInTheRobotsFrame) {
  Scan scan;
  scan.bearing0_rad = 0;
  scan.bearing_step_rad = std::numbers::pi / 2;
  scan.ranges_m = {1, infinite_range, 3, nan_range, 2};
  Laser laser;
  laser.robot_from_laser = {0.5, 0.25, std::numbers::pi / 2};
  const auto points = to_points(scan, laser, {});
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].beam, 0);
  EXPECT_EQ(points[1].beam, 2);
  EXPECT_EQ(points[2].beam, 4);
  EXPECT_NEAR((points[0].position - Eigen::Vector2d(0.5, 1.25)).norm(), 0, 1e-6);
  EXPECT_NEAR((points[1].position - Eigen::Vector2d(0.5, -2.75)).norm(), 0, 1e-6);
}

TEST(Scan, NormalsOnAWallAreItsOwnAndFaceTheLaser) {
  Scan scan = half_turn(181, 0);
  look_at(scan, {{0.4, 3}});
  Laser laser;
  laser.robot_from_laser = {0.2, -0.1, 0.3};
  const Eigen::Vector2d facing_laser = rotate(0.4 + 0.3, {-1, 0});
  int near = 0;
  for (const ScanPoint& point : to_points(scan, laser, {})) {
    const double distance = (point.position - Eigen::Vector2d(0.2, -0.1)).norm();
    if (distance > 6) continue;  // farther out, beams are too far apart
    ++near;
    ASSERT_TRUE(point.has_normal()) << point.beam;
    EXPECT_NEAR(point.normal.norm(), 1, 1e-9);
    EXPECT_NEAR((point.normal - facing_laser).norm(), 0, 1e-3) << point.beam;
  }
  EXPECT_GT(near, 100);
}

TEST(Scan, NormalsNearACornerBelongToOneOfItsWallsOrAreNone) {
  Scan scan = half_turn(721, 0);
  look_at(scan, {{0, 2}, {std::numbers::pi / 2, 2}, {-std::numbers::pi / 2, 2}});
  int along_first = 0;
  int along_second = 0;
  for (const ScanPoint& point : to_points(scan, {}, {})) {
    const Eigen::Vector2d& p = point.position;
    const double from_corner = (p - Eigen::Vector2d(2, 2)).norm();
    if (p.y() < 0 || from_corner < 0.31) continue;
    ASSERT_TRUE(point.has_normal()) << p.transpose();
    const bool on_first = p.x() > 2 - 1e-3;
    const Eigen::Vector2d expected = on_first ? Eigen::Vector2d(-1, 0) : Eigen::Vector2d(0, -1);
    EXPECT_NEAR((point.normal - expected).norm(), 0, 1e-3) << p.transpose();
    ++(on_first ? along_first : along_second);
  }
  EXPECT_GT(along_first, 50);
  EXPECT_GT(along_second, 50);
}

TEST(Scan, PointsAcrossAJumpDoNotBendNormals) {
  // A wall at 4 m, and a box's front at 2 m before its middle.
  Scan scan = half_turn(361, 0);
  look_at(scan, {{0, 4}});
  for (std::size_t i = 160; i <= 200; ++i) {
    scan.ranges_m[i] = static_cast<float>(2 / std::cos(testing::bearing_rad(scan, i)));
  }
  for (const ScanPoint& point : to_points(scan, {}, {})) {
    if (point.beam < 120 || point.beam > 240) continue;
    ASSERT_TRUE(point.has_normal()) << point.beam;
    EXPECT_NEAR((point.normal - Eigen::Vector2d(-1, 0)).norm(), 0, 1e-3) << point.beam;
  }
}

// A box stands 20 cm before the wall: within the arc that a normal is fitted over, but on the other side of a
// jump. So each surface's normals are its own to the very edge.
TEST(Scan, NormalsEndAtAJumpThatIsNearerThanTheirArcReaches) {
  Scan scan = half_turn(361, 0);
  look_at(scan, {{0, 2}});
  for (std::size_t i = 160; i <= 200; ++i)
    scan.ranges_m[i] = static_cast<float>(1.8 / std::cos(testing::bearing_rad(scan, i)));
  NormalOptions options;
  options.max_jump_m = 0.1;
  options.max_flatness_m = 0.2;
  for (const ScanPoint& point : to_points(scan, {}, options)) {
    if (point.beam < 140 || point.beam > 220) continue;
    ASSERT_TRUE(point.has_normal()) << point.beam;
    EXPECT_NEAR((point.normal - Eigen::Vector2d(-1, 0)).norm(), 0, 1e-3) << point.beam;
  }
}

// A wall 1.3 m to the left of a coarse laser, whose beams look aside by tenths of a degree at random: far
// ahead their ends lie half a metre apart.
//
//    ===========.===.====.======.==========.
//      o->
TEST(Scan, NoiseTurnsNormalsOfAWallThatRunsAwayNoMoreOneWayThanTheOther) {
  std::mt19937 engine(1);
  std::normal_distribution<double> aside_rad(0, 0.003);
  double sum_rad = 0;
  int count = 0;
  for (int drawn = 0; drawn < 2000; ++drawn) {
    Scan scan = half_turn(121, infinite_range);
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const double yaw_rad = testing::bearing_rad(scan, i) + aside_rad(engine);
      if (std::sin(yaw_rad) > 0.2) scan.ranges_m[i] = static_cast<float>(1.3 / std::sin(yaw_rad));
    }
    for (const ScanPoint& point : to_points(scan, {}, {})) {
      if (point.position.x() < 1.5 || point.position.x() > 5 || !point.has_normal()) continue;
      sum_rad += std::atan2(point.normal.x(), -point.normal.y());
      ++count;
    }
  }
  ASSERT_GT(count, 10'000);
  EXPECT_NEAR(sum_rad / count, 0, 0.0015);
}

// Of a wall 1.35 m to the left with doors that stand out of it by 10 cm, for a metre in three: where a beam
// ends.
//
//    =====     =====     =====     =====
//         |====      |===     |====
//      o->
double range_along_doors_m(double bearing_rad, double first_door_m) {
  constexpr double wall_m = 1.35, door_m = 1.25;
  if (std::sin(bearing_rad) < 0.1) return infinite_range;
  double range_m = wall_m / std::sin(bearing_rad);
  for (double begin_m = first_door_m; begin_m < 12; begin_m += 3) {
    const double at_door_m = door_m / std::tan(bearing_rad);
    if (at_door_m >= begin_m && at_door_m <= begin_m + 1) range_m = door_m / std::sin(bearing_rad);
    const double at_side_m = begin_m * std::tan(bearing_rad);
    if (begin_m > 0 && at_side_m >= door_m && at_side_m <= wall_m) range_m = begin_m / std::cos(bearing_rad);
  }
  return range_m;
}

struct MeanAndRms {
  double mean_m = 0;
  double rms_m = 0;
};

// Of the true ends of beams from the lines that a scan shows there, 3 to 5 m ahead; inward is positive.
MeanAndRms ends_from_lines_along_doors(const NormalOptions& options) {
  std::mt19937 engine(1);
  std::normal_distribution<double> noise_m(0, 0.0125);
  std::uniform_real_distribution<double> first_m(-6, -3);
  double sum_m = 0, squares_m2 = 0;
  int count = 0;
  for (int drawn = 0; drawn < 1000; ++drawn) {
    const double first_door_m = first_m(engine);
    Scan scan = half_turn(121, infinite_range);
    Scan truth = scan;
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const double range_m = range_along_doors_m(testing::bearing_rad(scan, i), first_door_m);
      truth.ranges_m[i] = static_cast<float>(range_m);
      scan.ranges_m[i] = static_cast<float>(range_m + noise_m(engine));
    }
    const auto true_points = to_points(truth, {}, options);
    const auto points = to_points(scan, {}, options);
    EXPECT_EQ(points.size(), true_points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d& end = true_points[i].position;
      if (end.x() < 3 || end.x() > 5 || !points[i].has_normal()) continue;
      const double off_m = points[i].distance_from_line_m(end);
      sum_m += off_m;
      squares_m2 += off_m * off_m;
      ++count;
    }
  }
  EXPECT_GT(count, 5'000);
  return {sum_m / count, std::sqrt(squares_m2 / count)};
}

TEST(Scan, LinesAlongAWallWithDoorsAheadLieOnItNotBehindIt) {
  NormalOptions through_all;
  through_all.noise_sigmas = 1000;
  const MeanAndRms before = ends_from_lines_along_doors(through_all);
  const MeanAndRms now = ends_from_lines_along_doors({});
  EXPECT_LT(before.mean_m, -0.003);
  EXPECT_NEAR(now.mean_m, 0, 0.002);
  EXPECT_LT(now.rms_m, 0.6 * before.rms_m);
}

// Ahead stands a shelf whose things stick out by 4 cm: no neighbours of a point lie on one line.
TEST(Scan, NormalsOfWhatIsRoughOnEitherSideAreThoseOfAllNeighbours) {
  NormalOptions through_all;
  through_all.noise_sigmas = 1000;
  std::mt19937 engine(1);
  std::normal_distribution<double> noise_m(0, 0.001);
  Scan scan = half_turn(361, infinite_range);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double yaw_rad = testing::bearing_rad(scan, i), sine = std::sin(yaw_rad);
    if (sine < 0.2) continue;
    const bool sticks_out = std::cos(yaw_rad) > 0 && sine < 0.5 && i % 4 < 2;
    scan.ranges_m[i] = static_cast<float>((sticks_out ? 1.26 : 1.3) / sine + noise_m(engine));
  }
  const auto points = to_points(scan, {}, {}), usual = to_points(scan, {}, through_all);
  int looked_at = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double sine = points[i].position.normalized().y();
    if (points[i].position.x() < 0 || sine > 0.45 || !usual[i].has_normal()) continue;
    EXPECT_EQ(points[i].normal, usual[i].normal) << points[i].position.x();
    ++looked_at;
  }
  EXPECT_GT(looked_at, 20);
}

// How rough a line may be is told by the laser's own noise, of a millimetre as of three centimetres.
TEST(Scan, NoiseAloneLeavesNormalsOfAWallAsAllItsNeighboursMakeThem) {
  NormalOptions through_all;
  through_all.noise_sigmas = 1000;
  for (const double sigma_m : {0.001, 0.01, 0.03}) {
    std::mt19937 engine(1);
    std::normal_distribution<double> noise_m(0, sigma_m);
    int count = 0, changed = 0;
    for (int drawn = 0; drawn < 200; ++drawn) {
      Scan scan = half_turn(181, infinite_range);
      for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
        const double sine = std::sin(testing::bearing_rad(scan, i));
        if (sine > 0.2 && sine < 0.5) scan.ranges_m[i] = static_cast<float>(1.3 / sine + noise_m(engine));
      }
      const auto points = to_points(scan, {}, {}), usual = to_points(scan, {}, through_all);
      for (std::size_t i = 0; i < points.size(); ++i) {
        ++count;
        changed += (points[i].normal - usual[i].normal).norm() > 1e-9;
      }
    }
    EXPECT_LT(changed, count / 100) << sigma_m;
  }
}

// Two walls of 4 m meet ahead at a right angle. Lines through both lie on neither; to either side of a point
// there is one of its own wall.
TEST(Scan, APointBesideACornerHasTheLineOfItsOwnWall) {
  Scan scan = half_turn(361, infinite_range);
  look_at(scan, {{0, 3}, {std::numbers::pi / 2, 2}});
  int beside = 0, with_line = 0;
  for (const ScanPoint& point : to_points(scan, {}, {})) {
    const double from_corner_m = (point.position - Eigen::Vector2d(3, 2)).norm();
    if (from_corner_m > 0.3) continue;
    ++beside;
    if (!point.has_normal()) continue;
    ++with_line;
    if (from_corner_m < 0.05) continue;
    const bool ahead = 3 - point.position.x() < 2 - point.position.y();
    const Eigen::Vector2d normal = ahead ? Eigen::Vector2d(-1, 0) : Eigen::Vector2d(0, -1);
    EXPECT_GT(point.normal.dot(normal), 0.95) << point.position.transpose();
  }
  EXPECT_GT(beside, 10);
  EXPECT_GT(with_line, 0.8 * beside);
}

// A wall 3 m ahead, through a laser whose ranges err by so much.
Scan noisy_wall(double sigma_m, std::mt19937& engine) {
  std::normal_distribution<double> noise_m(0, sigma_m);
  Scan scan = half_turn(181, infinite_range);
  for (std::size_t i = 45; i <= 135; ++i)
    scan.ranges_m[i] = static_cast<float>(3 / std::cos(testing::bearing_rad(scan, i)) + noise_m(engine));
  return scan;
}

TEST(Scan, AWallHasLinesHoweverMuchTheLaserErrs) {
  for (const double sigma_m : {0.01, 0.03, 0.06, 0.1}) {
    std::mt19937 engine(1);
    std::size_t count = 0, with_line = 0;
    for (int drawn = 0; drawn < 100; ++drawn) {
      for (const ScanPoint& point : to_points(noisy_wall(sigma_m, engine), {}, {})) {
        ++count;
        if (point.has_normal()) ++with_line;
      }
    }
    EXPECT_GT(static_cast<double>(with_line), 0.6 * static_cast<double>(count)) << sigma_m;
  }
}

// A curtain in folds of 20 cm beside the wall of a laser that errs by a centimetre.
TEST(Scan, WhatIsRougherThanNoiseAndSurfacesHasNoLine) {
  std::mt19937 engine(1);
  Scan scan = noisy_wall(0.01, engine);
  for (std::size_t i = 60; i < 80; ++i) scan.ranges_m[i] += i % 2 == 0 ? 0.1F : -0.1F;
  int in_folds = 0;
  for (const ScanPoint& point : to_points(scan, {}, {})) {
    const bool folded = point.beam >= 64 && point.beam < 76;
    if (folded) ++in_folds;
    EXPECT_TRUE(!folded || !point.has_normal()) << point.beam;
    EXPECT_TRUE(point.beam <= 84 || point.has_normal()) << point.beam;
  }
  EXPECT_EQ(in_folds, 12);
}

TEST(Scan, APointTellsTheNoiseAcrossItsLineAndWithoutOneThatOfItsRange) {
  constexpr double sigma_m = 0.03;
  std::mt19937 engine(1);
  double squared_ratio = 0;
  int lines = 0, alone = 0;
  for (int drawn = 0; drawn < 100; ++drawn) {
    Scan scan = noisy_wall(sigma_m, engine);
    scan.ranges_m[10] = 2;  // a pole
    for (const ScanPoint& point : to_points(scan, {}, {})) {
      const double noise_m2 = point.noise_m2;
      if (point.beam == 10) {
        ++alone;
        EXPECT_NEAR(std::sqrt(noise_m2), sigma_m, 0.5 * sigma_m);
      } else if (point.has_normal()) {
        const double sine = point.normal.dot(-point.position.normalized());
        squared_ratio += noise_m2 / (sigma_m * sigma_m * sine * sine);
        ++lines;
      }
    }
  }
  EXPECT_EQ(alone, 100);
  EXPECT_NEAR(squared_ratio / lines, 1, 0.2);
}

// Ahead of the robot a pillar stands out by 15 cm from the wall beside it, and hides some of it.
//
//    ===================.      ===========
//                       |______|. . .
//      o->
TEST(Scan, AShadowIsNoPartOfTheWallBehindIt) {
  Scan scan = half_turn(121, infinite_range);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double yaw_rad = testing::bearing_rad(scan, i);
    if (yaw_rad <= 0.2) continue;
    const bool on_pillar = 1.85 / std::tan(yaw_rad) > 2 && 1.85 / std::tan(yaw_rad) < 3;
    scan.ranges_m[i] = static_cast<float>((on_pillar ? 1.85 : 2) / std::sin(yaw_rad));
  }
  NormalOptions options;
  options.max_flatness_m = 0.2;
  int beyond = 0;
  for (const ScanPoint& point : to_points(scan, {}, options)) {
    if (point.position.x() < 2.4 || point.position.x() > 6.5 || !point.has_normal()) continue;
    EXPECT_NEAR((point.normal - Eigen::Vector2d(0, -1)).norm(), 0, 1e-3) << point.position.transpose();
    if (point.position.x() > 3) ++beyond;
  }
  EXPECT_GT(beyond, 3);
}

TEST(Scan, APointTellsHowFarThePointsOfItsLineAreSpread) {
  NormalOptions options;
  options.half_width_m = 1;
  for (const auto& [beside, spread_m2] : {std::pair(1, 0.02), {2, 0.1}}) {
    Scan scan;
    scan.bearing_step_rad = 1e-3;
    scan.bearing0_rad = -1e-3 * beside;
    scan.ranges_m.assign(2 * static_cast<std::size_t>(beside) + 1, 100);
    const auto points = to_points(scan, {{}, 0, 200}, options);
    EXPECT_NEAR(points[static_cast<std::size_t>(beside)].spread_m2, spread_m2, 1e-4);
  }
}

// One point of a wall 2 m ahead has come 3 cm too near. A sixtieth of that the line follows it.
TEST(Scan, DistancesFromAPointsLineHaveNothingOfThatPointsNoise) {
  Scan scan = half_turn(361, 0);
  look_at(scan, {{0, 2}});
  scan.ranges_m[180] -= 0.03F;
  const auto points = to_points(scan, {}, {});
  const auto near =
      std::find_if(points.begin(), points.end(), [](const ScanPoint& p) { return p.beam == 180; });
  ASSERT_NE(near, points.end());
  ASSERT_TRUE(near->has_normal());
  EXPECT_NEAR(near->position.x(), 1.97, 1e-6);
  EXPECT_NEAR(near->distance_from_line_m({2, 0}), 0, 0.002);
  EXPECT_NEAR(near->distance_from_line_m({1.5, 0.1}), 0.5, 0.004);
}

TEST(Scan, LonePointsHaveNoNormal) {
  Scan scan = half_turn(181, infinite_range);
  scan.ranges_m[20] = scan.ranges_m[90] = scan.ranges_m[160] = 5;
  const auto points = to_points(scan, {}, {});
  ASSERT_EQ(points.size(), 3U);
  for (const ScanPoint& point : points) EXPECT_FALSE(point.has_normal());
}

TEST(Scan, NegativeStepGivesTheSamePointsInTheOtherOrder) {
  Scan scan = half_turn(181, 0);
  look_at(scan, {{0.3, 3}, {-1.0, 2}, {1.4, 2.5}});
  const auto points = to_points(scan, {}, {});
  const auto other = to_points(reversed(scan), {}, {});
  ASSERT_EQ(points.size(), other.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ScanPoint& same = other[other.size() - 1 - i];
    EXPECT_NEAR((points[i].position - same.position).norm(), 0, 1e-6);
    EXPECT_NEAR((points[i].normal - same.normal).norm(), 0, 1e-6);
    EXPECT_EQ(points[i].beam + same.beam, 180);
  }
}

TEST(Scan, DegenerateScansGivePointsWithoutNormalsOrNone) {
  Scan scan = half_turn(181, 5);
  scan.ranges_m.clear();
  EXPECT_TRUE(to_points(scan, {}, {}).empty());
  EXPECT_TRUE(to_points(half_turn(181, nan_range), {}, {}).empty());
  EXPECT_TRUE(to_points(half_turn(181, infinite_range), {}, {}).empty());
  scan = half_turn(181, 5);
  scan.bearing_step_rad = 0;
  for (const ScanPoint& point : to_points(scan, {}, {}))
    EXPECT_FALSE(point.has_normal()) << "all in one place";
  scan.ranges_m = {5};
  ASSERT_EQ(to_points(scan, {}, {}).size(), 1U);
  EXPECT_FALSE(to_points(scan, {}, {})[0].has_normal());
}

}  // namespace
}  // namespace isthmus
