#include "patches/manifold.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <stdexcept>

#include "tests/support/patch_scenes.hpp"
#include "tests/support/poses.hpp"
#include "tests/support/solids.hpp"

namespace isthmus {
namespace {

using testing::area_m2;
using testing::expect_near;
using testing::full_turn;

PatchPtr disc(int id, float range_m) {
  return make_patch(PatchId{id}, "R1", full_turn(360, range_m), {}, {});
}

// Discs of radius 4 at x = 0, 5 and 20: the first two overlap.
Manifold three_discs() {
  Manifold manifold;
  manifold.add(disc(0, 4), {0, 0, 0});
  manifold.add(disc(1, 4), {5, 0, 1.0});
  manifold.add(disc(2, 4), {20, 0, -2.0});
  return manifold;
}

TEST(Manifold, RelativePoseIsTheSecondPatchSeenFromTheFirst) {
  Manifold manifold = three_discs();
  manifold.set_pose(PatchId{0}, {1, 2, std::numbers::pi / 2});
  expect_near(manifold.relative_pose(PatchId{0}, PatchId{1}), {-2, -4, 1 - std::numbers::pi / 2});
}

TEST(Patch, HoldsTheScanItsPointsAndItsFreeSpace) {
  Scan scan = full_turn(360, 0);
  scan.utime = 42;
  testing::look_at(scan,
                   {{0, 2}, {std::numbers::pi / 2, 2}, {std::numbers::pi, 2}, {-std::numbers::pi / 2, 2}});
  const PatchPtr patch = make_patch(PatchId{7}, "R2", scan, {}, {});
  EXPECT_EQ(patch->id, PatchId{7});
  EXPECT_EQ(patch->robot, "R2");
  EXPECT_EQ(patch->utime, 42);
  EXPECT_EQ(patch->points.size(), 360U);
  EXPECT_NEAR(area_m2(patch->free_space), 16, 0.2);
  EXPECT_TRUE(patch->star.contains({1, 1}));
  const int nearest = patch->index.nearest({2, 0.5});
  ASSERT_GE(nearest, 0);
  EXPECT_LT((patch->points[static_cast<std::size_t>(nearest)].position - Eigen::Vector2d(2, 0.5)).norm(),
            0.1);
}

TEST(Patch, ScanThatSawNothingIsStillAPatch) {
  const PatchPtr patch =
      make_patch(PatchId{0}, "R1", full_turn(360, std::numeric_limits<float>::quiet_NaN()), {}, {});
  EXPECT_TRUE(patch->points.empty());
  EXPECT_TRUE(patch->free_space.empty());
  EXPECT_EQ(patch->index.nearest({0, 0}), -1);
}

TEST(Manifold, IdsAreDense) {
  Manifold manifold;
  EXPECT_EQ(manifold.next_id(), PatchId{0});
  EXPECT_THROW(manifold.add(disc(3, 4), {}), std::logic_error);
  manifold.add(disc(0, 4), {1, 2, 3});
  EXPECT_EQ(manifold.next_id(), PatchId{1});
  EXPECT_EQ(manifold.pose(PatchId{0}), (Pose{1, 2, 3}));
}

TEST(Manifold, ProjectionIsThePosePlacedInItsPatch) {
  const Manifold manifold = three_discs();
  expect_near(manifold.project({PatchId{1}, {1, 0, 0.5}}), {5 + std::cos(1.0), std::sin(1.0), 1.5});
}

TEST(Manifold, TransformBetweenPatchesKeepsTheProjection) {
  // Equation 3.
  const Manifold manifold = three_discs();
  const ManifoldPose in_0{PatchId{0}, {2.5, 0.5, 0.3}};
  const ManifoldPose in_1 = manifold.transform(in_0, PatchId{1});
  EXPECT_EQ(in_1.patch, PatchId{1});
  expect_near(manifold.project(in_1), manifold.project(in_0));
  expect_near(manifold.transform(in_1, PatchId{0}).patch_from_object, in_0.patch_from_object);
}

TEST(Manifold, SamePoseNeedsAgreementAndOverlap) {
  // Equation 2: the same place in the plane is the same place of the manifold only where patches overlap.
  const Manifold manifold = three_discs();
  const ManifoldPose in_0{PatchId{0}, {2.5, 0.5, 0.3}};
  const ManifoldPose in_1 = manifold.transform(in_0, PatchId{1});
  EXPECT_TRUE(manifold.same_pose(in_0, in_1));
  ManifoldPose shifted = in_1;
  shifted.patch_from_object.x += 0.01;
  EXPECT_FALSE(manifold.same_pose(in_0, shifted));
  EXPECT_TRUE(manifold.same_pose(in_0, shifted, 0.02));
  ManifoldPose turned = in_1;
  turned.patch_from_object.yaw += 0.01;
  EXPECT_FALSE(manifold.same_pose(in_0, turned));
  EXPECT_FALSE(manifold.same_pose(in_0, manifold.transform(in_0, PatchId{2}))) << "no overlap";
}

TEST(Manifold, OverlapFollowsThePoses) {
  Manifold manifold = three_discs();
  EXPECT_TRUE(manifold.overlap(PatchId{0}, PatchId{1}));
  EXPECT_FALSE(manifold.overlap(PatchId{0}, PatchId{2}));
  manifold.set_pose(PatchId{2}, {0, 7, 3.0});
  EXPECT_TRUE(manifold.overlap(PatchId{0}, PatchId{2}));
}

TEST(Manifold, BackProjectionTakesTheNearestPatchThatContainsThePosition) {
  // Equation 14.
  const Manifold manifold = three_discs();
  const std::vector<PatchId> all{PatchId{0}, PatchId{1}, PatchId{2}};
  for (const auto& [x, expected] : {std::pair{1.0, 0}, {2.0, 0}, {3.0, 1}, {6.0, 1}, {19.0, 2}}) {
    const auto back = manifold.project_back({x, 0.1, 0.4}, all);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->patch, PatchId{expected}) << x;
    expect_near(manifold.project(*back), {x, 0.1, 0.4});
  }
}

TEST(Manifold, BackProjectionPrefersAContainingPatchToANearerOne) {
  Manifold manifold;
  manifold.add(disc(0, 1), {0, 0, 0});
  manifold.add(disc(1, 10), {5, 0, 0});
  const std::vector<PatchId> both{PatchId{0}, PatchId{1}};
  EXPECT_EQ(manifold.project_back({1.5, 0, 0}, both)->patch, PatchId{1});
}

TEST(Manifold, BackProjectionOutsideEveryPatchTakesTheNearestOrigin) {
  const Manifold manifold = three_discs();
  const std::vector<PatchId> all{PatchId{0}, PatchId{1}, PatchId{2}};
  EXPECT_EQ(manifold.project_back({14, 0, 0}, all)->patch, PatchId{2});
  EXPECT_FALSE(manifold.project_back({14, 0, 0}, {}));
}

// A laser that looks ahead sees nothing of where the robot itself stands and backs to:
//
//            . - ~
//     x  o->       )    x: behind the laser, within the footprint
//            ` - ~
TEST(Manifold, APatchContainsItsFootprintThoughItsLaserLookedAway) {
  Manifold manifold;
  manifold.add(make_patch(PatchId{0}, "R1", testing::half_turn(181, 4), {}, {}), {0, 0, 0});
  manifold.add(disc(1, 10), {2, 0, 0});
  const std::vector<PatchId> both{PatchId{0}, PatchId{1}};
  const double inside = Manifold::footprint_m - 0.05, outside = Manifold::footprint_m + 0.05;
  EXPECT_EQ(manifold.project_back({-inside, 0, 0}, both)->patch, PatchId{0});
  EXPECT_EQ(manifold.project_back({-outside, 0, 0}, both)->patch, PatchId{1})
      << "nearer, but it saw nothing there";
  EXPECT_EQ(manifold.project_back({0.9, 0, 0}, both)->patch, PatchId{0}) << "ahead, the laser saw it free";
}

// The patch of a robot without a laser is what its footprint swept.
TEST(Manifold, APatchWithoutAScanContainsItsFootprint) {
  Manifold manifold;
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  manifold.add(make_patch(PatchId{0}, "R1", full_turn(360, nothing), {}, {}), {0, 0, 0});
  manifold.add(disc(1, 10), {3, 0, 0});
  const std::vector<PatchId> both{PatchId{0}, PatchId{1}};
  EXPECT_EQ(manifold.project_back({0, 0.4, 0}, both)->patch, PatchId{0});
  EXPECT_EQ(manifold.project_back({0, 0.6, 0}, both)->patch, PatchId{1});
}
}  // namespace
}  // namespace isthmus
