#include "server/paths/questions/relative_pose.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "relations/mount_survey.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

/// Patches a metre apart along x, each tied to the one before with these sigmas.
Map chain(int patches, double sigma_m = 0.1, double sigma_rad = 1e-4) {
  Map map;
  for (int i = 0; i < patches; ++i) {
    map.add(testing::round_patch(testing::furnished_room(), PatchId{i}, {}), {1.0 * i, 0, 0});
    if (i == 0) continue;
    const double m = 1 / (sigma_m * sigma_m), rad = 1 / (sigma_rad * sigma_rad);
    map.relate(testing::odometry_relation(PatchId{i - 1}, PatchId{i}, {1, 0, 0}, {m, m, rad}));
  }
  return map;
}

PlacedObject object(int patch, const Pose& pose = {},
                    const Eigen::Vector3d& sigmas = Eigen::Vector3d::Zero()) {
  return {{PatchId{patch}, pose}, sigmas.cwiseAbs2().asDiagonal()};
}

TEST(RelativePose, IsOneThingSeenFromAnother) {
  const MapCopy map = testing::copy_of(chain(4));
  const auto answer =
      relative_pose(map, object(0, {1, 0, 0.5 * std::numbers::pi}), object(3, {1, 2, std::numbers::pi}));
  ASSERT_EQ(answer.refusal, Refusal::none);
  EXPECT_NEAR(answer.a_from_b.x, 2, 1e-9);
  EXPECT_NEAR(answer.a_from_b.y, -3, 1e-9);
  EXPECT_NEAR(answer.a_from_b.yaw, 0.5 * std::numbers::pi, 1e-9);
}

TEST(RelativePose, VariancesOfTheChainAddUp) {
  const auto answer = relative_pose(testing::copy_of(chain(5)), object(0), object(4));
  EXPECT_NEAR(answer.covariance(0, 0), 4 * 0.01, 1e-6);
  EXPECT_EQ(answer.chain, (std::vector<RelationId>{{0}, {1}, {2}, {3}}));
}

TEST(RelativePose, WhatTheObjectsAreUncertainOfIsAddedInTheFirstOnesFrame) {
  const auto turned = object(0, {0, 0, 0.5 * std::numbers::pi});
  const auto answer =
      relative_pose(testing::copy_of(chain(1)), turned, object(0, {3, 0, 0}, {0.3, 0.1, 0.02}));
  EXPECT_NEAR(answer.covariance(0, 0), 0.01, 1e-9);
  EXPECT_NEAR(answer.covariance(1, 1), 0.09, 1e-9);
  EXPECT_TRUE(answer.chain.empty());
  const auto unsure =
      relative_pose(testing::copy_of(chain(1)), object(0, {}, {0, 0, 0.1}), object(0, {3, 0, 0}));
  EXPECT_NEAR(unsure.covariance(1, 1), 9 * 0.01, 1e-9);  // 3 m away, across the line of sight
}

TEST(RelativePose, OfRobotsSaysWhatTheirLasersMountsMayBeOffBy) {
  const MapCopy map = testing::copy_of(chain(2));
  const auto between = [&](const char* a, const char* b) {
    PlacedObject one = object(0), other = object(1);
    one.robot = a;
    other.robot = b;
    return relative_pose(map, one, other).covariance;
  };
  const Eigen::Matrix3d by_relations = between("", "");
  EXPECT_TRUE((between("R1", "R2") - by_relations).isApprox(mount_covariance({1, 0, 0}, "R1", "R2"), 1e-6));
  EXPECT_TRUE((between("R1", "R1") - by_relations).isApprox(mount_covariance({1, 0, 0}, "R1", "R1"), 1e-6));
}

TEST(RelativePose, TheChainGoesByTheStrongerRelations) {
  Map map = chain(4, 0.5);
  const RelationId shortcut = map.relate(testing::odometry_relation(PatchId{0}, PatchId{3}, {3, 0, 0}));
  EXPECT_EQ(relative_pose(testing::copy_of(map), object(0), object(3)).chain,
            std::vector<RelationId>{shortcut});
}

TEST(RelativePose, TheChainDoesNotGoByAWeakShortcut) {
  Map map = chain(4);
  map.relate(testing::odometry_relation(PatchId{0}, PatchId{3}, {3, 0, 0}, {1, 1, 1}));
  EXPECT_EQ(relative_pose(testing::copy_of(map), object(0), object(3)).chain,
            (std::vector<RelationId>{{0}, {1}, {2}}));
}

TEST(RelativePose, AcrossIslandsItIsNotKnown) {
  Map map = chain(2);
  map.add(testing::round_patch(testing::furnished_room(), PatchId{2}, {}), {});
  const MapCopy copy = testing::copy_of(map);
  EXPECT_EQ(relative_pose(copy, object(0), object(2)).refusal, Refusal::other_island);
}

TEST(RelativePose, WhatIsNoPoseIsRefused) {
  MapCopy map = testing::copy_of(chain(2));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(relative_pose(map, object(0), object(2)).refusal, Refusal::unknown_patch);
  EXPECT_EQ(relative_pose(map, object(-1), object(1)).refusal, Refusal::unknown_patch);
  EXPECT_EQ(relative_pose(map, object(0, {nan, 0, 0}), object(1)).refusal, Refusal::bad_value);
  EXPECT_EQ(relative_pose(map, object(0), object(1, {}, {nan, 0, 0})).refusal, Refusal::bad_value);
  map.left_out = {PatchId{1}};
  EXPECT_EQ(relative_pose(map, object(0), object(1)).refusal, Refusal::unknown_patch);
}

TEST(RelativePose, WhatTheRelationsDoNotDetermineIsNotKnown) {
  Map map = chain(1);
  map.add(testing::round_patch(testing::furnished_room(), PatchId{1}, {}), {1, 0, 0});
  Relation range;
  range.a = PatchId{0};
  range.b = PatchId{1};
  range.kind = RelationKind::range;
  Range apart;
  apart.range_m = 1;
  apart.sigma_m = 0.1;
  range.measurement = apart;
  map.relate(range);
  EXPECT_EQ(relative_pose(testing::copy_of(map), object(0), object(1)).refusal, Refusal::undetermined);
}

}  // namespace
}  // namespace isthmus
