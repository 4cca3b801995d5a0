#include "server/engine/places/place_memory.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

/// A row of patches in a room, half a metre from one to the next.
Map row_of(int patches) {
  std::vector<Pose> way;
  for (int i = 0; i < patches; ++i) way.push_back({-2.5 + 0.5 * i, -1.5, 0});
  Map map;
  add_way(map, crooked_room(), way, Pose{});
  return map;
}

void expect_same(const RigidPiece& given, const RigidPiece& expected) {
  EXPECT_EQ(given.local.reference, expected.local.reference);
  ASSERT_EQ(given.local.patches.size(), expected.local.patches.size());
  for (std::size_t i = 0; i < given.local.patches.size(); ++i) {
    EXPECT_EQ(given.local.patches[i].patch, expected.local.patches[i].patch);
    EXPECT_EQ(given.local.patches[i].local_from_patch, expected.local.patches[i].local_from_patch);
  }
  EXPECT_EQ(positions(given.points), positions(expected.points));
}

TEST(PlaceMemory, HasThePlacesThatTheMapHasNow) {
  Map map = row_of(8);
  PlaceMemory memory;
  const auto expect_as_the_map_has_it = [&](PatchId anchor, const std::vector<PatchId>& without) {
    expect_same(memory.around(map, anchor, without, {}), place_around(map, anchor, without, {}));
  };
  const std::vector<PatchId> some = {PatchId{2}, PatchId{5}};
  for (int again = 0; again < 2; ++again) {
    expect_as_the_map_has_it(PatchId{1}, {});
    expect_as_the_map_has_it(PatchId{1}, some);
    expect_as_the_map_has_it(PatchId{6}, {});
  }
  EXPECT_EQ(memory.size(), 2U);
  const std::size_t before = memory.around(map, PatchId{1}, {}, {}).local.patches.size();
  const PatchId added = map.manifold().next_id();
  map.add(patch_from(crooked_room(), added, {-2, -1, 0}), {-2, -1, 0});
  map.relate(odometry_relation(PatchId{1}, added, map.relative_pose(PatchId{1}, added), {1e4, 1e4, 1e5}));
  expect_as_the_map_has_it(PatchId{1}, {});
  EXPECT_EQ(memory.around(map, PatchId{1}, {}, {}).local.patches.size(), before + 1);
}

TEST(PlaceMemory, ForgetsThePlacesThatWereAskedForLongestAgo) {
  const Map map = row_of(3);
  PlaceMemory memory(2);
  memory.around(map, PatchId{0}, {}, {});
  memory.around(map, PatchId{1}, {}, {});
  memory.around(map, PatchId{0}, {}, {});
  memory.around(map, PatchId{2}, {}, {});
  EXPECT_TRUE(memory.knows(PatchId{0}));
  EXPECT_FALSE(memory.knows(PatchId{1}));
  EXPECT_TRUE(memory.knows(PatchId{2}));
  memory.around(map, PatchId{2}, {}, {});
  EXPECT_TRUE(memory.knows(PatchId{0})) << "what is known needs no room";
}

}  // namespace
}  // namespace isthmus
