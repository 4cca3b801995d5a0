#include "tools/simulate/live/seen_ground.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace isthmus {
namespace {

/// A room of 8 m by 4 m.
FloorPlan room_of_8_m() {
  Building building;
  building.walls.push_back({{{0, 0}, {8, 0}, {8, 4}, {0, 4}}, true, {}});
  return build_floor_plan(building);
}

/// Half a turn ahead, every beam of one range.
Scan half_turn(float range_m) {
  Scan scan{0, -1.5708, 3.1416 / 180, {}};
  scan.ranges_m.assign(181, range_m);
  return scan;
}

TEST(SeenGround, IsWhatLiesWithinTheBeams) {
  const FloorPlan plan = room_of_8_m();
  const ReachableGround ground(plan, RayCaster(plan), {4, 2}, 0.3);
  SeenGround seen(ground);
  Laser laser;
  laser.range_max_m = 20;
  EXPECT_EQ(seen.share(), 0);
  seen.add({4, 2, 0}, half_turn(1), laser);
  EXPECT_NEAR(seen.share() * ground.area_m2(), 0.5 * 3.14, 0.2);
  seen.add({4, 2, 0}, half_turn(std::numeric_limits<float>::infinity()), laser);
  EXPECT_NEAR(seen.share(), 0.5, 0.03);
  seen.add({4, 2, 3.1416}, half_turn(9), laser);
  EXPECT_EQ(seen.share(), 1);
}

TEST(SeenGround, BeyondItsRangeALaserSeesNothing) {
  const FloorPlan plan = room_of_8_m();
  const ReachableGround ground(plan, RayCaster(plan), {4, 2}, 0.3);
  SeenGround seen(ground);
  Laser laser;
  laser.range_max_m = 1;
  seen.add({4, 2, 0}, half_turn(std::numeric_limits<float>::infinity()), laser);
  EXPECT_NEAR(seen.share() * ground.area_m2(), 0.5 * 3.14, 0.2);
}

}  // namespace
}  // namespace isthmus
