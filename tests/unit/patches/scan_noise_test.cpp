#include "patches/scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/patch_scenes.hpp"

namespace isthmus {
namespace {

using testing::half_turn;
using testing::infinite_range;
using testing::look_at;

// A wall 1.3 m to the left of a coarse laser, whose beams look aside by tenths of a degree at random: far
// ahead their ends lie half a metre apart.
//
//    ===========.===.====.======.==========.
//      o->
TEST(ScanNoise, NoiseTurnsNormalsOfAWallThatRunsAwayNoMoreOneWayThanTheOther) {
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

// How rough a line may be is told by the laser's own noise, of a millimetre as of three centimetres.
TEST(ScanNoise, NoiseAloneLeavesNormalsOfAWallAsAllItsNeighboursMakeThem) {
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

// A wall 3 m ahead, through a laser whose ranges err by so much.
Scan noisy_wall(double sigma_m, std::mt19937& engine) {
  std::normal_distribution<double> noise_m(0, sigma_m);
  Scan scan = half_turn(181, infinite_range);
  for (std::size_t i = 45; i <= 135; ++i)
    scan.ranges_m[i] = static_cast<float>(3 / std::cos(testing::bearing_rad(scan, i)) + noise_m(engine));
  return scan;
}

TEST(ScanNoise, AWallHasLinesHoweverMuchTheLaserErrs) {
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
TEST(ScanNoise, WhatIsRougherThanNoiseAndSurfacesHasNoLine) {
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

TEST(ScanNoise, APointTellsTheNoiseAcrossItsLineAndWithoutOneThatOfItsRange) {
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

// One point of a wall 2 m ahead has come 3 cm too near. A sixtieth of that the line follows it.
TEST(ScanNoise, DistancesFromAPointsLineHaveNothingOfThatPointsNoise) {
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

}  // namespace
}  // namespace isthmus
