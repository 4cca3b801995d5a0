#include "server/paths/ground/near_patches.hpp"

#include <gtest/gtest.h>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::Spiral;

TEST(NearPatches, WaysAlongRelationsAreMeasuredAndNotThroughThePicture) {
  const Spiral spiral;
  const NearPatches near(testing::copy_of(spiral.map), 30);
  EXPECT_EQ(near.way_m(PatchId{3}, PatchId{3}), 0);
  EXPECT_NEAR(near.way_m(PatchId{3}, PatchId{13}), 10, 0.1);
  EXPECT_NEAR(near.way_m(PatchId{13}, PatchId{3}), 10, 0.1);
  EXPECT_FALSE(near.near(PatchId{3}, PatchId{3 + Spiral::lap_patches}));  // one on the other
}

TEST(NearPatches, WaysBeyondTheReachAreNotKnown) {
  const Spiral spiral;
  const NearPatches near(testing::copy_of(spiral.map), 30);
  EXPECT_TRUE(near.near(PatchId{0}, PatchId{30}));
  EXPECT_FALSE(near.near(PatchId{0}, PatchId{31}));
}

TEST(NearPatches, ARelationIsAShorterWay) {
  Spiral spiral;
  spiral.close(3);
  const NearPatches near(testing::copy_of(spiral.map), 30);
  EXPECT_NEAR(near.way_m(PatchId{3}, PatchId{3 + Spiral::lap_patches}), 0, 1e-3);
  EXPECT_NEAR(near.way_m(PatchId{5}, PatchId{4 + Spiral::lap_patches}), 3, 0.1);
}

TEST(NearPatches, PatchesThatAreNotThereAreNearNothing) {
  const Spiral spiral;
  const NearPatches near(testing::copy_of(spiral.map), 30);
  EXPECT_FALSE(near.near(PatchId{}, PatchId{3}));
  EXPECT_FALSE(near.near(PatchId{3}, PatchId{100'000}));
  EXPECT_FALSE(near.near(PatchId{100'000}, PatchId{3}));
}

}  // namespace
}  // namespace isthmus
