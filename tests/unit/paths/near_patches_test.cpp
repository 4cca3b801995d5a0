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

/// Four patches in a row, 10 m apart.
Map row_of_four() {
  Map map;
  for (int i = 0; i < 4; ++i) {
    map.add(testing::round_patch(testing::furnished_room(), PatchId{i}, {}, 1), {10.0 * i, 0, 0});
    if (i > 0) map.relate(testing::odometry_relation(PatchId{i - 1}, PatchId{i}, {10, 0, 0}));
  }
  return map;
}

TEST(NearPatches, KeptUpWhereAFitHasMovedPatchesApartTheWayIsLonger) {
  const MapCopy before = testing::copy_of(row_of_four());
  MapCopy after = before;
  after.poses[3].x += 5;
  const NearPatches near = NearPatches(before, 60).kept_up(after);
  EXPECT_NEAR(near.way_m(PatchId{0}, PatchId{3}), 35, 1e-3);
  EXPECT_NEAR(near.way_m(PatchId{3}, PatchId{2}), 15, 1e-3);
}

TEST(NearPatches, KeptUpWhereARelationIsGoneThereIsNoWayByIt) {
  Map map = row_of_four();
  const NearPatches before(testing::copy_of(map), 60);
  map.remove(map.graph().between(PatchId{2}, PatchId{3}));
  const NearPatches near = before.kept_up(testing::copy_of(map));
  EXPECT_FALSE(near.near(PatchId{0}, PatchId{3}));
  EXPECT_TRUE(near.near(PatchId{0}, PatchId{2}));
  EXPECT_EQ(near.changes(before).size(), 3U) << "of the last with each other";
}

}  // namespace
}  // namespace isthmus
