#include <gtest/gtest.h>

#include <algorithm>

#include "patches/manifold.hpp"
#include "random_solids.hpp"
#include "tests/property/drawn.hpp"

namespace isthmus {
namespace {

using testing::any_laser;
using testing::any_pose;
using testing::any_scan;

Manifold any_manifold() {
  Manifold manifold;
  const int patches = *rc::gen::inRange(1, 6);
  for (int i = 0; i < patches; ++i) {
    manifold.add(make_patch(PatchId{i}, "R1", any_scan(40), any_laser(), {}), any_pose(8));
  }
  return manifold;
}

PatchId any_patch(const Manifold& manifold) {
  return PatchId{*rc::gen::inRange(0, static_cast<int>(manifold.size()))};
}

void expect_same_pose(const Pose& a, const Pose& b) {
  RC_ASSERT(std::hypot(a.x - b.x, a.y - b.y) < 1e-9);
  RC_ASSERT(std::abs(wrap_angle(a.yaw - b.yaw)) < 1e-9);
}

TEST(ManifoldProperty, TransformKeepsTheProjectionAndIsUndoneByItsReturn) {
  EXPECT_TRUE(rc::check([] {
    const Manifold manifold = any_manifold();
    const ManifoldPose here{any_patch(manifold), any_pose(5)};
    const ManifoldPose there = manifold.transform(here, any_patch(manifold));
    expect_same_pose(manifold.project(there), manifold.project(here));
    expect_same_pose(manifold.transform(there, here.patch).patch_from_object, here.patch_from_object);
  }));
}

TEST(ManifoldProperty, SamePoseIsSymmetricAndHoldsAfterATransformIffPatchesOverlap) {
  EXPECT_TRUE(rc::check([] {
    const Manifold manifold = any_manifold();
    const ManifoldPose here{any_patch(manifold), any_pose(5)};
    const ManifoldPose there = manifold.transform(here, any_patch(manifold));
    const bool overlap = manifold.overlap(here.patch, there.patch);
    RC_TAG(overlap);
    RC_ASSERT(manifold.same_pose(here, there) == overlap);
    RC_ASSERT(manifold.same_pose(there, here) == overlap);
  }));
}

TEST(ManifoldProperty, OverlapDoesNotDependOnWhereTheMapLies) {
  EXPECT_TRUE(rc::check([] {
    Manifold manifold = any_manifold();
    const PatchId a = any_patch(manifold);
    const PatchId b = any_patch(manifold);
    const auto shared_m2 = [&] {
      return testing::shared_area_m2(transformed(manifold.pose(a), manifold.patch(a).free_space),
                                     transformed(manifold.pose(b), manifold.patch(b).free_space));
    };
    const bool before = manifold.overlap(a, b);
    RC_PRE(shared_m2() > 1e-4 || !before);  // not by a hair
    const Pose motion = any_pose(100);
    const Pose moved_a = motion * manifold.pose(a);
    const Pose moved_b = motion * manifold.pose(b);
    manifold.set_pose(a, moved_a);
    manifold.set_pose(b, moved_b);
    RC_ASSERT(manifold.overlap(a, b) == before);
  }));
}

TEST(ManifoldProperty, BackProjectionKeepsThePoseAndNoCandidateIsBetter) {
  EXPECT_TRUE(rc::check([] {
    const Manifold manifold = any_manifold();
    std::vector<PatchId> candidates;
    for (int i = 0; i < static_cast<int>(manifold.size()); ++i) candidates.push_back(PatchId{i});
    const Pose object = any_pose(10);
    const auto back = manifold.project_back(object, candidates);
    RC_ASSERT(back.has_value());
    expect_same_pose(manifold.project(*back), object);
    const auto holds = [&](PatchId id) {
      const Pose r = ominus(object, manifold.pose(id));
      return std::hypot(r.x, r.y) <= Manifold::footprint_m || manifold.patch(id).star.contains({r.x, r.y});
    };
    const auto distance = [&](PatchId id) {
      return std::hypot(object.x - manifold.pose(id).x, object.y - manifold.pose(id).y);
    };
    for (const PatchId id : candidates) {
      RC_ASSERT(!holds(id) || holds(back->patch));
      if (holds(id) == holds(back->patch)) RC_ASSERT(distance(back->patch) <= distance(id) + 1e-9);
    }
  }));
}

}  // namespace
}  // namespace isthmus
