#include "server/engine/sightings/tag_placer.hpp"

#include <gtest/gtest.h>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

const Eigen::Vector2d hook{1, 1};  // where a tag hangs, in the world, which is R1's island

/// R1 sees a tag at some seconds; the placer has had its turn.
struct Tags {
  SideBySide scene;
  MutualObservations observations;
  TagPlacer placer;

  void see(std::int32_t barcode, const Eigen::Vector2d& place, const std::vector<double>& seconds) {
    for (const double s : seconds)
      observations.take(SideBySide::seen("R1", s, barcode, place), tag_name(barcode), true, 0);
    observations.place(scene.world(16), placer.patches());
    placer.place(scene.world(16), observations);
  }
  Verdict verdict(std::size_t record) const { return observations.log()[record].verdict; }
};

TEST(TagPlacer, PlacesATagWhereThreeSightingsHaveIt) {
  Tags tags;
  tags.see(50, hook, {10, 12, 14});
  ASSERT_TRUE(tags.placer.patches().contains(50));
  const PatchId patch = tags.placer.patches().at(50);
  EXPECT_EQ(tags.scene.map.manifold().patch(patch).tag, 50);
  EXPECT_NEAR(tags.scene.map.manifold().pose(patch).x, 1, 0.01);
  EXPECT_NEAR(tags.scene.map.manifold().pose(patch).y, 1, 0.01);
  EXPECT_EQ(tags.scene.map.graph().of(patch).size(), 3U);
  EXPECT_TRUE(tags.observations.pool().empty());
  EXPECT_EQ(tags.observations.log()[0].reason, Reason::placed_tag);
}

TEST(TagPlacer, LeavesATagThatTooFewHaveSeen) {
  Tags tags;
  tags.see(50, hook, {12, 12.1});  // from one place
  EXPECT_TRUE(tags.placer.patches().empty());
  EXPECT_EQ(tags.observations.pool().size(), 2U);
}

TEST(TagPlacer, LeavesATagThatSightingsPutInDifferentPlaces) {
  Tags tags;
  tags.see(50, hook, {10});
  tags.see(50, {3, -1}, {12});
  tags.see(50, {-3, 2}, {14});
  EXPECT_TRUE(tags.placer.patches().empty());
}

// A misread barcode repeats itself where another tag hangs.
TEST(TagPlacer, BelievesInATagBesideAnotherOnlyWhenManyHaveSeenIt) {
  Tags tags;
  tags.see(50, hook, {10, 12, 14});
  tags.see(51, hook, {10, 12, 14});
  EXPECT_FALSE(tags.placer.patches().contains(51));
  ASSERT_EQ(tags.observations.pool().size(), 3U);
  EXPECT_EQ(tags.observations.pool()[0].doubt, Reason::another_tag_is_there);
  tags.see(51, hook, {11, 13, 15});
  EXPECT_TRUE(tags.placer.patches().contains(51));
}

TEST(TagPlacer, DisplacesATagThatTooLittleIsLeftOf) {
  Tags tags;
  tags.see(50, hook, {10, 12, 14});
  Map& map = tags.scene.map;
  const PatchId patch = tags.placer.patches().at(50);
  std::vector<Relation> gone;
  for (const RelationId id : map.graph().of(patch)) gone.push_back(*map.graph().find(id));
  gone.pop_back();
  map.remove(std::vector<RelationId>{gone[0].id, gone[1].id});
  tags.placer.displace(map, gone, {});
  EXPECT_TRUE(tags.placer.patches().empty());
  EXPECT_EQ(gone.size(), 3U);
  EXPECT_TRUE(map.graph().of(patch).empty());
}

TEST(TagPlacer, KeepsATagThatWouldStillBePlaced) {
  Tags tags;
  tags.see(50, hook, {10, 11, 12, 14});
  Map& map = tags.scene.map;
  std::vector<Relation> gone{*map.graph().find(map.graph().of(tags.placer.patches().at(50)).front())};
  map.remove(std::vector<RelationId>{gone[0].id});
  tags.placer.displace(map, gone, {});
  EXPECT_TRUE(tags.placer.patches().contains(50));
  EXPECT_EQ(gone.size(), 1U);
}

}  // namespace
}  // namespace isthmus
