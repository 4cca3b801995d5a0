#include "patches/scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/patch_scenes.hpp"

namespace isthmus {
namespace {

using testing::half_turn;
using testing::infinite_range;
using testing::look_at;

TEST(ScanNormals, NormalsOnAWallAreItsOwnAndFaceTheLaser) {
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

TEST(ScanNormals, NormalsNearACornerBelongToOneOfItsWallsOrAreNone) {
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

TEST(ScanNormals, PointsAcrossAJumpDoNotBendNormals) {
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
TEST(ScanNormals, NormalsEndAtAJumpThatIsNearerThanTheirArcReaches) {
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

TEST(ScanNormals, LinesAlongAWallWithDoorsAheadLieOnItNotBehindIt) {
  NormalOptions through_all;
  through_all.noise_sigmas = 1000;
  const MeanAndRms before = ends_from_lines_along_doors(through_all);
  const MeanAndRms now = ends_from_lines_along_doors({});
  EXPECT_LT(before.mean_m, -0.003);
  EXPECT_NEAR(now.mean_m, 0, 0.002);
  EXPECT_LT(now.rms_m, 0.6 * before.rms_m);
}

// Ahead stands a shelf whose things stick out by 4 cm: no neighbours of a point lie on one line.
TEST(ScanNormals, NormalsOfWhatIsRoughOnEitherSideAreThoseOfAllNeighbours) {
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

// Two walls of 4 m meet ahead at a right angle. Lines through both lie on neither; to either side of a point
// there is one of its own wall.
TEST(ScanNormals, APointBesideACornerHasTheLineOfItsOwnWall) {
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

// Ahead of the robot a pillar stands out by 15 cm from the wall beside it, and hides some of it.
//
//    ===================.      ===========
//                       |______|. . .
//      o->
TEST(ScanNormals, AShadowIsNoPartOfTheWallBehindIt) {
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

TEST(ScanNormals, APointTellsHowFarThePointsOfItsLineAreSpread) {
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

TEST(ScanNormals, LonePointsHaveNoNormal) {
  Scan scan = half_turn(181, infinite_range);
  scan.ranges_m[20] = scan.ranges_m[90] = scan.ranges_m[160] = 5;
  const auto points = to_points(scan, {}, {});
  ASSERT_EQ(points.size(), 3U);
  for (const ScanPoint& point : points) EXPECT_FALSE(point.has_normal());
}

}  // namespace
}  // namespace isthmus
