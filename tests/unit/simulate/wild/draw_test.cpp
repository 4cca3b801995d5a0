#include "tools/simulate/wild/draw.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace isthmus {
namespace {

constexpr std::uint64_t seeds = 2000;
constexpr double degree = std::numbers::pi / 180;

std::vector<WildDraw> draws() {
  std::vector<WildDraw> all;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) all.push_back(draw_wild(seed));
  return all;
}

TEST(WildDraw, IsTheSameForTheSameSeedAndAnotherForAnother) {
  for (const std::uint64_t seed : {1U, 2U, 77U}) {
    const WildDraw one = draw_wild(seed), same = draw_wild(seed), other = draw_wild(seed + 1);
    EXPECT_EQ(describe(one), describe(same));
    EXPECT_EQ(one.robots.front().laser.range_sigma_m, same.robots.front().laser.range_sigma_m);
    EXPECT_EQ(one.robots.back().odometry.angular_scale, same.robots.back().odometry.angular_scale);
    EXPECT_EQ(one.building.room_m, same.building.room_m);
    EXPECT_NE(one.building.room_m, other.building.room_m);
    EXPECT_NE(describe(one), describe(other));
  }
}

TEST(WildDraw, BuildingsAreWithinTheirBounds) {
  for (const WildDraw& draw : draws()) {
    const WildBuilding& building = draw.building;
    EXPECT_GE(building.corridor_m, 1.9);
    EXPECT_LE(building.corridor_m, 3.2);
    EXPECT_LE(building.length_m, building.corridors_along_x == 1 ? 200 : 500);
    EXPECT_GE(building.length_m, 12);
    EXPECT_GE(building.corridors_along_x, building.width_m > 0 ? 2 : 1);
    EXPECT_LE(building.glass_share, 0.15);
    EXPECT_GE(building.fixture_m, 1.2);
    EXPECT_LE(building.fixture_m, 5);
    EXPECT_LE(building.changes, 3);
  }
}

TEST(WildDraw, CorridorsAreOfAllKindsFromCrowdedToNearlyBare) {
  std::vector<double> fixtures_m;
  for (const WildDraw& draw : draws()) fixtures_m.push_back(draw.building.fixture_m);
  EXPECT_LT(std::ranges::min(fixtures_m), 1.3);
  EXPECT_GT(std::ranges::max(fixtures_m), 4.8);
}

TEST(WildDraw, LasersAndWheelsAreWithinTheirBounds) {
  for (const WildDraw& draw : draws()) {
    EXPECT_GE(draw.robots.size(), 1U);
    EXPECT_LE(draw.robots.size(), 6U);
    for (const WildRobot& robot : draw.robots) {
      EXPECT_GE(robot.laser.beams, 90);
      EXPECT_LE(robot.laser.beams, 1081);
      EXPECT_GE(robot.laser.field_of_view_rad, 179 * degree);
      EXPECT_LT(robot.laser.field_of_view_rad, 360 * degree);
      EXPECT_GE(robot.laser.laser.range_max_m, 4);
      EXPECT_LE(robot.laser.laser.range_max_m, 30);
      EXPECT_LE(std::abs(robot.laser.declared_mount_error.x), 0.02);
      EXPECT_LE(std::abs(robot.laser.declared_mount_error.yaw), degree);
      EXPECT_NEAR(robot.odometry.linear_scale, 1, 0.1);
      EXPECT_LE(robot.faults.jitter_s, 0.01);
      EXPECT_LE(robot.faults.lag_s, 0.15);
    }
  }
}

TEST(WildDraw, ToursAreOfTenMinutesOrSoAndTeamsThatAreLargeHaveShortOnes) {
  double sum_s = 0;
  for (const WildDraw& draw : draws()) {
    EXPECT_GE(draw.tour.loop_m, 50);
    EXPECT_LE(draw.tour.loop_m, 1000);
    EXPECT_GE(draw.tour.laps, 1);
    EXPECT_LE(draw.tour.laps, 3);
    double scans = 0;
    for (const WildRobot& robot : draw.robots) {
      const double drive_s = draw.tour.loop_m * draw.tour.laps / robot.drive.speed_mps;
      scans += drive_s * robot.laser.rate_hz;
      sum_s += drive_s / static_cast<double>(seeds * draw.robots.size());
    }
    EXPECT_LE(scans, draw.robots.size() > 1 ? 5000 : 8000);
  }
  EXPECT_GT(sum_s, 200);
  EXPECT_LT(sum_s, 700);
}

TEST(WildDraw, CampusesHaveWideStreetsRoundHousesAndLasersThatSeeFar) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const WildDraw draw = draw_wild(seed, WildPlace::campus);
    const WildBuilding& campus = draw.building;
    EXPECT_EQ(campus.kind, WildKind::campus);
    EXPECT_GE(campus.corridor_m, 8);
    EXPECT_LE(campus.corridor_m, 28);
    EXPECT_GE(campus.width_m / (campus.corridors_along_x - 1), campus.corridor_m + 18 - 1e-9);
    EXPECT_GE(campus.length_m / (campus.corridors_along_y - 1), campus.corridor_m + 18 - 1e-9);
    EXPECT_GE(draw.tour.loop_m, 250);
    EXPECT_LE(draw.tour.loop_m * draw.tour.laps, 900);
    for (const WildRobot& robot : draw.robots) {
      EXPECT_GE(robot.laser.laser.range_max_m, 25);
      EXPECT_LE(robot.laser.laser.range_max_m, 80);
    }
  }
}

TEST(WildDraw, EachTraitIsDrawnOftenAndNoneAlways) {
  std::map<std::string, std::size_t> drawn;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed)
    for (const WildTrait& trait :
         traits_of(draw_wild(seed, seed % 5 == 0 ? WildPlace::campus : WildPlace::building)))
      drawn[trait.name] += trait.holds ? 1U : 0U;
  for (const auto& [name, count] : drawn) {
    EXPECT_GT(count, seeds / 50) << name;
    EXPECT_LT(count, seeds * 9 / 10) << name;
  }
}

TEST(WildDraw, ARobotAloneHasNoSightings) {
  for (const WildDraw& draw : draws()) {
    if (draw.robots.size() > 1) continue;
    EXPECT_EQ(draw.camera.rate_hz, 0);
    EXPECT_EQ(draw.false_sightings, 0);
  }
}

}  // namespace
}  // namespace isthmus
