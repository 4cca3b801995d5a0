#include "server/engine/robot/teammates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/relations.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr std::int64_t seen_utime = 100'000'000;

SightingEvent sighting_of_second(double range_m, double bearing_rad) {
  return {"R1", seen_utime, 2, range_m, 0.02, bearing_rad, 0.01};
}

std::map<std::string, Robot> two_declared_robots() {
  std::map<std::string, Robot> robots;
  robots["R1"].declaration = {"R1", 0, 1, laser_of(), 0.25, false};
  robots["R2"].declaration = {"R2", 0, 2, laser_of(), 0.3, false};
  return robots;
}

void stand(Robot& robot, int patch, const Pose& patch_from_robot, std::int64_t utime = seen_utime) {
  robot.place = Localisation{};
  robot.place->pose = {PatchId{patch}, patch_from_robot};
  robot.place->utime = utime;
}

Map map_of_two_patches() {
  Map map;
  map.add(patch_from(furnished_room(), PatchId{0}, {}), {1, 1, 0});
  map.add(patch_from(furnished_room(), PatchId{1}, {}), {3, 1, 0.5});
  return map;
}

TEST(WithoutBodies, TakesAwayBeamsThatEndOnABodyAndNoOthers) {
  const Scan scan = scan_from(furnished_room(), {});
  const Laser laser = laser_of();
  const Body body{{2.5, 1.8}, 0.6};  // at the cupboard's corner
  const Scan clean = without_bodies(scan, laser, {body});
  ASSERT_EQ(clean.ranges_m.size(), scan.ranges_m.size());
  int taken = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double bearing = scan.bearing0_rad + static_cast<double>(i) * scan.bearing_step_rad;
    const Eigen::Vector2d end = scan.ranges_m[i] * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
    if ((end - body.position).norm() < body.radius_m) {
      EXPECT_TRUE(std::isnan(clean.ranges_m[i])) << i;
      ++taken;
    } else {
      EXPECT_EQ(clean.ranges_m[i], scan.ranges_m[i]) << i;
    }
  }
  EXPECT_GT(taken, 5);
  EXPECT_LT(taken, 60);
  EXPECT_EQ(clean.utime, scan.utime);
  EXPECT_EQ(clean.bearing0_rad, scan.bearing0_rad);
}

TEST(WithoutBodies, KnowsWhereTheLaserSits) {
  Laser laser = laser_of();
  laser.robot_from_laser = {0.2, -0.1, std::numbers::pi};
  Scan scan{seen_utime, 0, 0.1, {2, 2}};  // the first beam ends at (-1.8, -0.1) of the robot
  const Scan clean = without_bodies(scan, laser, {{{-1.8, -0.1}, 0.1}});
  EXPECT_TRUE(std::isnan(clean.ranges_m[0]));
  EXPECT_EQ(clean.ranges_m[1], 2);
}

// A body in front of a wall that a beam passes by, or one behind it, is not what the beam hit; and no-returns
// hit nothing.
TEST(WithoutBodies, LeavesBeamsThatPassABodyAndThoseWithoutReturn) {
  Scan scan{seen_utime, 0, 0.1, {5, std::numeric_limits<float>::infinity(), 20, 0}};
  const Scan clean = without_bodies(scan, laser_of(), {{{2, 0}, 0.5}, {{7, 0}, 0.5}, {{20, 4}, 3}});
  EXPECT_EQ(clean.ranges_m, scan.ranges_m);
  EXPECT_EQ(without_bodies(scan, laser_of(), {}).ranges_m, scan.ranges_m);
}

TEST(Teammates, OneJustSeenIsABodyWhereItWasSeen) {
  auto robots = two_declared_robots();
  const Pose odom_then{5, 5, 0.5 * std::numbers::pi};
  note_teammate(robots["R1"], sighting_of_second(2, 0), "R2", odom_then);
  const auto bodies = teammates_around({}, robots, robots["R1"], odom_then, seen_utime, {});
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_NEAR((bodies[0].position - Eigen::Vector2d(2, 0)).norm(), 0, 1e-9);
  EXPECT_GT(bodies[0].radius_m, 0.3);  // its footprint
  EXPECT_LT(bodies[0].radius_m, 0.7);

  // The observer has moved on by 1 m and a quarter turn within half a second.
  const Pose odom_now{5, 6, std::numbers::pi};
  const auto later = teammates_around({}, robots, robots["R1"], odom_now, seen_utime + 500'000, {});
  ASSERT_EQ(later.size(), 1U);
  EXPECT_NEAR((later[0].position - Eigen::Vector2d(0, -1)).norm(), 0, 1e-9);
  EXPECT_GT(later[0].radius_m, bodies[0].radius_m);

  EXPECT_TRUE(teammates_around({}, robots, robots["R1"], odom_now, seen_utime + 2'000'000, {}).empty());
}

TEST(Teammates, ARangeOrABearingAloneSaysNotWhereABodyIs) {
  auto robots = two_declared_robots();
  SightingEvent ranged = sighting_of_second(2, 0), turned = sighting_of_second(2, 0);
  ranged.bearing_sigma_rad = turned.range_sigma_m = std::numeric_limits<double>::infinity();
  note_teammate(robots["R1"], ranged, "R2", {});
  note_teammate(robots["R1"], turned, "R2", {});
  EXPECT_TRUE(teammates_around({}, robots, robots["R1"], {}, seen_utime, {}).empty());
}

// R1 at (2, 1) looking along y, R2 at (3, 1) of the same island: a metre to the right.
TEST(Teammates, OneOnTheSameIslandIsABodyWhereTheMapHasIt) {
  Map map = map_of_two_patches();
  map.relate(odometry_between(0, 1));
  auto robots = two_declared_robots();
  stand(robots["R1"], 0, {1, 0, 0.5 * std::numbers::pi});
  stand(robots["R2"], 1, {});
  const auto bodies = teammates_around(map, robots, robots["R1"], {}, seen_utime, {});
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_NEAR((bodies[0].position - Eigen::Vector2d(0, -1)).norm(), 0, 1e-9);
  EXPECT_NEAR(bodies[0].radius_m, 0.3 + 0.15, 1e-9);
}

TEST(Teammates, OneOnAnotherIslandOrLongUnheardOfIsNone) {
  auto robots = two_declared_robots();
  stand(robots["R1"], 0, {});
  stand(robots["R2"], 1, {});
  EXPECT_TRUE(teammates_around(map_of_two_patches(), robots, robots["R1"], {}, seen_utime, {}).empty());
  Map map = map_of_two_patches();
  map.relate(odometry_between(0, 1));
  stand(robots["R2"], 1, {}, seen_utime - 60'000'000);
  EXPECT_TRUE(teammates_around(map, robots, robots["R1"], {}, seen_utime, {}).empty());
}

}  // namespace
}  // namespace isthmus
