#include "server/output/foxglove/map_content.hpp"

#include <gtest/gtest.h>

#include "tests/support/relations.hpp"
#include "tests/support/walls.hpp"

namespace isthmus::foxglove {
namespace {

/// Patches of a robot in the furnished room, each an island but for 0 and 1.
MapCopy islands_at(const std::vector<Pose>& poses) {
  MapCopy map;
  for (const Pose& pose : poses) {
    const PatchId id{static_cast<std::int32_t>(map.patches.size())};
    map.patches.push_back(testing::patch_from(testing::furnished_room(), id, pose));
    map.poses.push_back(pose);
    map.graph.add_patch(id);
  }
  Relation closure = testing::odometry_between(0, 1);
  closure.origin.closure = ClosureId{5};
  map.graph.add(closure);
  return map;
}

std::vector<Island> ranked(const MapCopy& map) {
  std::vector<Island> islands;
  for (const auto& patches : rank_islands(map).patches)
    islands.push_back({island_frame(static_cast<int>(islands.size())), patches});
  return islands;
}

TEST(FoxgloveMap, IslandsLieSideBySideAndStayAsTheyGrow) {
  const MapCopy map = islands_at({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 1}});
  const auto islands = ranked(map);
  const auto transforms = side_by_side(map, islands);
  ASSERT_EQ(transforms.size(), 3U);
  EXPECT_EQ(transforms[0].parent_from_child.x, 0);
  for (std::size_t i = 1; i < 3; ++i) {
    const double right = island_box(map, islands[i - 1].patches).high.x();
    const double left = island_box(map, islands[i].patches).low.x();
    EXPECT_GT(transforms[i].parent_from_child.x + left, transforms[i - 1].parent_from_child.x + right);
  }
  MapCopy grown = map;
  grown.poses[1].x += 0.2;
  const auto later = side_by_side(grown, islands);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(later[i].parent_from_child.x, transforms[i].parent_from_child.x);
}

TEST(FoxgloveMap, ScenesShowPatchesTagsAndClosuresOnTheirIsland) {
  MapCopy map = islands_at({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}});
  map.tags.resize(2);
  map.tags[0].barcode = 17;
  map.tags[0].position = {3, 4};
  map.tags[0].patch = PatchId{2};  // the other is not placed
  const auto all = scenes(map, ranked(map));
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].frame, "island-0");
  EXPECT_EQ(all[0].patches.size(), 2U);
  ASSERT_EQ(all[0].closures.size(), 1U);
  EXPECT_EQ(all[0].closures[0].to.x() - all[0].closures[0].from.x(), 1);
  EXPECT_TRUE(all[0].tags.empty());
  ASSERT_EQ(all[1].tags.size(), 1U);
  EXPECT_EQ(all[1].tags[0].text, "17");
  EXPECT_TRUE(all[1].closures.empty());
}

TEST(FoxgloveMap, ClosuresAreToldWithTheirReason) {
  ClosureRecord closure;
  closure.id = ClosureId{3};
  closure.kind = ClosureKind::merge;
  closure.state = ClosureState::withdrawn;
  closure.reason = Reason::contradicted;
  closure.robots = {"R1", "R2"};
  EXPECT_EQ(closure_text(closure), "merge 3 withdrawn (contradicted): R1, R2");
  EXPECT_EQ(closure_level(closure), Level::warning);
  closure.state = ClosureState::accepted;
  EXPECT_EQ(closure_level(closure), Level::info);
}

}  // namespace
}  // namespace isthmus::foxglove
