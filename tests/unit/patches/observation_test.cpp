#include "patches/observation.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "patches/patch.hpp"
#include "tests/support/patch_scenes.hpp"

namespace isthmus {
namespace {

// A robot whose laser sits 0.2 m ahead of its origin, in a disc of 4 m around the laser.
Observation in_a_disc() {
  Scan scan = testing::full_turn(360, 4);
  scan.utime = 42;
  return observe(scan, {{0.2, 0, 0}, 0.05, 80}, {});
}

TEST(Observation, HoldsTheScanItsPointsAndItsFreeSpaceInTheRobotsFrame) {
  const Observation seen = in_a_disc();
  EXPECT_EQ(seen.scan.utime, 42);
  EXPECT_EQ(seen.scan.ranges_m.size(), 360U);
  EXPECT_EQ(seen.laser.robot_from_laser, (Pose{0.2, 0, 0}));
  ASSERT_EQ(seen.points.size(), 360U);
  for (const ScanPoint& point : seen.points)
    EXPECT_NEAR((point.position - Eigen::Vector2d(0.2, 0)).norm(), 4, 1e-6);
  EXPECT_TRUE(seen.star.contains({4.1, 0}));
  EXPECT_FALSE(seen.star.contains({-3.9, 0}));
}

TEST(Observation, IsFreeAsFarAsTheOptionsTrustIt) {
  PatchOptions options;
  options.free_space.max_range_m = 3;
  EXPECT_NEAR(observe(testing::full_turn(360, 4), {}, options).star.reach_m(), 3, 1e-6);
  options.free_space.no_return_range_m = 2;
  EXPECT_NEAR(observe(testing::full_turn(360, 100), {}, options).star.reach_m(), 2, 1e-6);
}

TEST(Observation, BecomesThePatchAsItIs) {
  Observation seen = in_a_disc();
  seen.points.resize(7);
  seen.star = Star(testing::full_turn(360, 1), {}, 80, 0);
  const ScanPoint* points = seen.points.data();
  const PatchPtr patch = make_patch(PatchId{3}, "R2", std::move(seen), {});
  EXPECT_EQ(patch->id, PatchId{3});
  EXPECT_EQ(patch->robot, "R2");
  EXPECT_EQ(patch->utime, 42);
  EXPECT_EQ(patch->points.data(), points) << "made once";
  EXPECT_EQ(patch->points.size(), 7U);
  EXPECT_NEAR(patch->star.reach_m(), 1, 1e-6);
}

}  // namespace
}  // namespace isthmus
