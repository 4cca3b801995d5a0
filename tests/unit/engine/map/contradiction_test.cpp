#include "server/engine/map/contradiction.hpp"

#include <gtest/gtest.h>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

double contradiction_of(const Walls& a, const Walls& b, const Pose& a_from_b = {}) {
  const std::optional<double> share =
      contradiction(*patch_from(a, PatchId{0}, {}), *patch_from(b, PatchId{1}, {}), a_from_b, {});
  EXPECT_TRUE(share.has_value());
  return share.value_or(-1);
}

TEST(Contradiction, IsNoneWhereBothSeeTheSame) {
  EXPECT_EQ(contradiction_of(furnished_room(), furnished_room()), 0);
  const PatchPtr here = patch_from(furnished_room(), PatchId{0}, {});
  const PatchPtr there = patch_from(furnished_room(), PatchId{1}, {1, 0.5, 0.4});
  EXPECT_LT(contradiction(*here, *there, {1, 0.5, 0.4}, {}).value_or(1), 0.1);
}

// All walls of the small room stand where the large one was seen to be empty, and each patch's walls count:
// those of the large room are hidden behind the small one's.
TEST(Contradiction, IsAllWhereWallsStandInFreeSpace) {
  EXPECT_EQ(contradiction_of(box(2), box(4)), 1);
  EXPECT_EQ(contradiction_of(box(4), box(2)), 1) << "in both directions";
}

TEST(Contradiction, ForgivesHalfAMetre) {
  EXPECT_EQ(contradiction_of(box(3), box(3.3)), 0);
  EXPECT_EQ(contradiction_of(box(3), box(4)), 1);
}

// A patch in the other's frame: a metre to the side one wall of each pair lies deep.
TEST(Contradiction, LooksFromWhereThePatchesLie) {
  EXPECT_GT(contradiction_of(box(3), box(3), {0, 1.5, 0}), 0.15);
}

TEST(Contradiction, IsUnknownWhereTheyHardlyLookAtTheSamePlace) {
  const PatchPtr room = patch_from(box(2), PatchId{0}, {});
  EXPECT_FALSE(contradiction(*room, *patch_from(box(2), PatchId{1}, {}), {50, 0, 0}, {}));
}

TEST(MeanContradiction, IsOverThePairsThatLookAtTheSamePlace) {
  const PatchPtr small = patch_from(box(2), PatchId{0}, {});
  const PatchPtr large = patch_from(box(4), PatchId{1}, {});
  MeanContradiction mean{ContradictionOptions{}};
  EXPECT_EQ(mean.mean(0.25), 0.25) << "of none";
  mean.add(*small, *large, {});
  mean.add(*small, *small, {});
  mean.add(*small, *large, {50, 0, 0});
  EXPECT_EQ(mean.pairs(), 2);
  EXPECT_EQ(mean.mean(), 0.5);
}

TEST(MeanContradiction, TakesPatchesWhereTheManifoldHasThem) {
  Manifold manifold;
  manifold.add(patch_from(box(2), PatchId{0}, {}), {10, 0, 1});
  manifold.add(patch_from(box(4), PatchId{1}, {}), {10, 0, 1});
  manifold.add(patch_from(box(4), PatchId{2}, {}), {60, 0, 1});
  MeanContradiction mean{ContradictionOptions{}};
  mean.add(manifold, PatchId{0}, PatchId{1});
  mean.add(manifold, PatchId{0}, PatchId{2});
  EXPECT_EQ(mean.pairs(), 1);
  EXPECT_EQ(mean.mean(), 1);
}

// The first patch is contradicted by three others, the second by nobody.
TEST(ContradictionByPatch, CountsEachPatchOnceHoweverManyItIsComparedWith) {
  Manifold manifold;
  for (int i = 0; i < 4; ++i) manifold.add(patch_from(box(4), PatchId{i}, {}), {10, 0, 1});
  manifold.add(patch_from(box(2), PatchId{4}, {}), {10, 0, 1});
  manifold.add(patch_from(box(4), PatchId{5}, {}), {60, 0, 1});
  ContradictionByPatch found(manifold, ContradictionOptions{});
  EXPECT_EQ(found.mean(), 0);
  found.add(PatchId{4}, std::vector<PatchId>{PatchId{0}, PatchId{1}, PatchId{2}});
  found.add(PatchId{3}, std::vector<PatchId>{PatchId{0}});
  found.add(PatchId{5}, std::vector<PatchId>{PatchId{0}});
  EXPECT_EQ(found.pairs(), 4) << "the last looks at another place";
  EXPECT_EQ(found.mean(), 0.5);
}

}  // namespace
}  // namespace isthmus
