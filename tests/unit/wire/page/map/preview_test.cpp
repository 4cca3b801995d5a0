#include "server/wire/page/map/preview.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;
using testing::map_of_islands;
using testing::odometry_between;
using testing::shown_of;

constexpr ClosureId merge_id{4};

Relation of_merge(int a, int b) {
  Relation relation = odometry_between(a, b);
  relation.origin = {OriginKind::sighting, merge_id, 0};
  return relation;
}

/// Two islands of three and of two patches, joined by a merge with a sighting:
///
///     0 - 1 - 2 ~~~ 3 - 4
MapCopy merged_map() {
  MapCopy map = map_of_islands({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{3, 0, 0}, {3.5, 0, 0}}});
  map.graph.add(of_merge(2, 3));
  ClosureRecord record;
  record.id = merge_id;
  record.kind = ClosureKind::merge;
  record.state = ClosureState::accepted;
  map.closures = {record};
  map.sightings = {{{"R1", 1, 7, 1, 0.1, 0, 0.1}, Verdict::accepted, Reason::merged_islands, merge_id},
                   {{"R1", 2, 7, 1, 0.1, 0, 0.1}, Verdict::waiting, Reason::none, ClosureId{}}};
  return map;
}

TEST(Preview, AMergeThatAloneJoinsTwoIslandsPartsThem) {
  const Json preview = Json::parse(closure_preview(shown_of(merged_map()), merge_id));
  EXPECT_EQ(preview.at("relations"), Json({{"sighting", 1}}));
  EXPECT_EQ(preview.at("sightings"), Json({{"accepted", 1}}));
  EXPECT_EQ(preview.at("dependent"), 0);
  EXPECT_EQ(preview.at("parts"), Json({3, 2}));
  EXPECT_EQ(preview.at("parts_at_most"), Json({3, 2}));
}

TEST(Preview, WhatWasMatchedOnceTheyHadMergedMayHoldThemTogetherOrNot) {
  MapCopy map = merged_map();
  Relation match = odometry_between(1, 4);
  match.origin.kind = OriginKind::match;
  map.graph.add(match);
  const Json preview = Json::parse(closure_preview(shown_of(map), merge_id));
  EXPECT_EQ(preview.at("dependent"), 1);
  EXPECT_EQ(preview.at("parts"), Json({5}));
  EXPECT_EQ(preview.at("parts_at_most"), Json({3, 2}));
}

TEST(Preview, ThereIsNoneOfAClosureThatIsNotThere) {
  EXPECT_EQ(closure_preview(shown_of(merged_map()), ClosureId{5}), "");
}

TEST(Preview, ARobotWithoutPatchesHasContributedNothing) {
  EXPECT_EQ(Json::parse(robot_preview(shown_of(merged_map()), "R2")), Json({{"robot", "R2"},
                                                                            {"patches", 0},
                                                                            {"left_out", 0},
                                                                            {"relations", 0},
                                                                            {"closures", Json::object()}}));
}

TEST(Preview, OfADroppedRobotItTellsWhatWouldComeBack) {
  MapCopy map = map_of_islands({{{0, 0, 0}}, {{3, 0, 0}, {3.5, 0, 0}}});
  map.left_out = {PatchId{0}};
  const Json preview = Json::parse(robot_preview(shown_of(map), "R1"));
  EXPECT_EQ(preview.at("left_out"), 1);
  EXPECT_EQ(preview.at("patches"), 2) << "what it has sent since";
}

TEST(Preview, ADroppedRobotTakesItsPatchesTheirRelationsAndWhatTheseHoldTogether) {
  EXPECT_EQ(Json::parse(robot_preview(shown_of(merged_map()), "R1")), Json({{"robot", "R1"},
                                                                            {"patches", 5},
                                                                            {"left_out", 0},
                                                                            {"relations", 4},
                                                                            {"closures", {{"merge", 1}}}}));
}

}  // namespace
}  // namespace isthmus
