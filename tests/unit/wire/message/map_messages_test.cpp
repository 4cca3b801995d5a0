#include "server/wire/message/map_messages.hpp"

#include <gtest/gtest.h>

#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

/// Patches 1 m apart on a line, each related to the one before: one island.
MapCopy line_of_patches(int count) {
  MapCopy map;
  for (int i = 0; i < count; ++i) {
    const Scan scan{i, -1.5, 0.1, std::vector<float>(31, 4.0F)};
    map.patches.push_back(make_patch(PatchId{i}, "R1", scan, Laser{}, PatchOptions{}));
    map.poses.push_back({static_cast<double>(i), 0, 0});
    map.graph.add_patch(PatchId{i});
    if (i == 0) continue;
    Relation relation;
    relation.a = PatchId{i - 1};
    relation.b = PatchId{i};
    relation.kind = RelationKind::odometry;
    relation.measurement = RelativePose{{1, 0, 0}, Eigen::Matrix3d::Identity()};
    map.graph.add(relation);
  }
  return map;
}

std::size_t patches_in(const std::vector<map_t>& chunks) {
  std::size_t count = 0;
  for (const map_t& chunk : chunks) count += chunk.patches.size();
  return count;
}

TEST(MapMessages, WholeMapHasEveryPatchWithItsFreeSpace) {
  MapMessages messages;
  const auto chunks = messages.whole(line_of_patches(3), 7);
  ASSERT_EQ(chunks.size(), 1U);
  EXPECT_TRUE(chunks[0].whole);
  EXPECT_EQ(chunks[0].utime, 7);
  ASSERT_EQ(chunks[0].npatches, 3);
  EXPECT_EQ(chunks[0].nrelations, 2);
  const patch_t& patch = chunks[0].patches[2];
  EXPECT_EQ(patch.id, 2);
  EXPECT_EQ(patch.island, 0);
  EXPECT_EQ(patch.map_from_patch[0], 2);
  ASSERT_EQ(patch.nrings, 1);
  EXPECT_EQ(patch.ring_sizes[0], patch.nvertices);
  EXPECT_GE(patch.nvertices, 3);
  EXPECT_EQ(chunks[0].relations[0].kind, "odometry");
}

TEST(MapMessages, AnEmptyMapIsOneEmptyChunk) {
  const auto chunks = MapMessages().whole(MapCopy{}, 1);
  ASSERT_EQ(chunks.size(), 1U);
  EXPECT_EQ(chunks[0].npatches, 0);
}

TEST(MapMessages, ALargeMapComesInChunksOfADatagramEach) {
  MapMessages messages;
  const auto chunks = messages.whole(line_of_patches(1000), 1);
  EXPECT_GT(chunks.size(), 1U);
  EXPECT_EQ(patches_in(chunks), 1000U);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    EXPECT_EQ(chunks[i].chunk, static_cast<std::int32_t>(i));
    EXPECT_EQ(chunks[i].nchunks, static_cast<std::int32_t>(chunks.size()));
    EXPECT_LT(encoded(chunks[i]).size(), 65'000U);
  }
}

TEST(MapMessages, NothingIsSentWhereNothingChanged) {
  MapMessages messages;
  MapCopy map = line_of_patches(3);
  messages.whole(map, 1);
  EXPECT_TRUE(messages.changes(map, 2).empty());
  map.poses[1].x += 0.1 * MapMessages::still_m;
  EXPECT_TRUE(messages.changes(map, 3).empty());
}

// Slow drift must not go unseen because each step of it is small.
TEST(MapMessages, SmallMovesAddUp) {
  MapMessages messages;
  MapCopy map = line_of_patches(3);
  messages.whole(map, 1);
  std::size_t sent = 0;
  for (int i = 0; i < 25; ++i) {
    map.poses[1].x += 0.1 * MapMessages::still_m;
    sent += patches_in(messages.changes(map, 2));
  }
  EXPECT_EQ(sent, 2U);
}

TEST(MapMessages, OnlyWhatChangedIsSent) {
  MapMessages messages;
  messages.whole(line_of_patches(3), 1);
  MapCopy map = line_of_patches(4);
  map.poses[1].yaw = 0.5;
  map.graph.remove(RelationId{0});
  const auto chunks = messages.changes(map, 2);
  ASSERT_EQ(chunks.size(), 1U);
  EXPECT_FALSE(chunks[0].whole);
  ASSERT_EQ(chunks[0].removed_relations, std::vector<std::int32_t>{0});
  ASSERT_EQ(chunks[0].nrelations, 1);
  EXPECT_EQ(chunks[0].relations[0].b, 3);
  // The parting gave patches 1 to 3 another island: all of them are told, with free space only the new one.
  ASSERT_EQ(chunks[0].npatches, 3);
  for (const patch_t& patch : chunks[0].patches) {
    EXPECT_EQ(patch.island, 1);
    EXPECT_EQ(patch.nrings > 0, patch.id == 3);
  }
  EXPECT_TRUE(messages.changes(map, 3).empty());
}

}  // namespace
}  // namespace isthmus
