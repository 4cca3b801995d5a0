#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

MapCopy small_map() {
  return testing::map_of(testing::rectangle(0, 0, 4, 4), {{1, 1, 0}, {2, 2, 0.5}, {3, 2, 0}});
}

ClosureRecord closure(std::int32_t id, ClosureState state) {
  ClosureRecord record;
  record.id = ClosureId{id};
  record.kind = ClosureKind::loop;
  record.state = state;
  return record;
}

TEST(MapSha256, IsSixtyFourHexDigitsAndTheSameForTheSameMap) {
  const std::string sha = map_sha256(small_map());
  EXPECT_EQ(sha.size(), 64u);
  EXPECT_EQ(sha.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_EQ(sha, map_sha256(small_map()));
}

TEST(MapSha256, TheLastBitOfAPoseCounts) {
  MapCopy map = small_map();
  map.poses[1].yaw = std::nextafter(map.poses[1].yaw, 1.0);
  EXPECT_NE(map_sha256(map), map_sha256(small_map()));
}

TEST(MapSha256, WhatAPatchIsCounts) {
  const MapCopy map = small_map();
  for (const auto change : {+[](Patch& patch) { patch.robot = "R2"; }, +[](Patch& patch) { ++patch.utime; },
                            +[](Patch& patch) { patch.scan.ranges_m[7] += 0.001F; },
                            +[](Patch& patch) { patch.laser.robot_from_laser.x = 0.1; }}) {
    MapCopy changed = map;
    Patch patch = *map.patches[0];
    change(patch);
    changed.patches[0] = std::make_shared<const Patch>(patch);
    EXPECT_NE(map_sha256(changed), map_sha256(map));
  }
}

/// The same relations, the first of them changed.
RelationGraph with_first_relation(const RelationGraph& graph, void (*change)(Relation&)) {
  RelationGraph changed;
  for (std::size_t i = 0; i < graph.patch_count(); ++i)
    changed.add_patch(PatchId{static_cast<std::int32_t>(i)});
  for (const auto& [id, relation] : graph.relations()) {
    Relation copy = relation;
    if (id == RelationId{0}) change(copy);
    changed.add(std::move(copy));
  }
  return changed;
}

TEST(MapSha256, WhatARelationMeasuredAndWhereItCameFromCount) {
  const MapCopy map = small_map();
  for (const auto change :
       {+[](Relation& relation) { std::get<RelativePose>(relation.measurement).information(0, 1) = 1e-300; },
        +[](Relation& relation) { std::get<RelativePose>(relation.measurement).a_from_b.x += 1e-12; },
        +[](Relation& relation) { relation.origin.closure = ClosureId{0}; },
        +[](Relation& relation) { relation.robust_scale = 2; }}) {
    MapCopy changed = map;
    changed.graph = with_first_relation(map.graph, change);
    EXPECT_NE(map_sha256(changed), map_sha256(map));
  }
}

TEST(MapSha256, PlacesAndZonesCount) {
  MapCopy map = small_map();
  AnnotationRecord zone;
  zone.kind = AnnotationKind::keep_out;
  zone.name = "z";
  zone.points = {{PatchId{0}, {0, 0, 0}}, {PatchId{0}, {1, 0, 0}}, {PatchId{0}, {0, 1, 0}}};
  map.annotations = {zone};
  const std::string sha = map_sha256(map);
  EXPECT_NE(sha, map_sha256(small_map()));
  for (const auto change : {+[](AnnotationRecord& one) { one.name = "y"; },
                            +[](AnnotationRecord& one) { one.kind = AnnotationKind::speed; },
                            +[](AnnotationRecord& one) { one.max_speed_m_s = 1; },
                            +[](AnnotationRecord& one) { one.points[1].patch_from_object.x += 1e-12; }}) {
    MapCopy changed = map;
    change(changed.annotations.front());
    EXPECT_NE(map_sha256(changed), sha);
  }
}

TEST(MapSha256, AcceptedClosuresCountAndRefusedOnesLeaveNoTrace) {
  const MapCopy map = small_map();
  MapCopy refused = map;
  refused.closures = {closure(0, ClosureState::refused), closure(1, ClosureState::withdrawn),
                      closure(2, ClosureState::waiting)};
  EXPECT_EQ(map_sha256(refused), map_sha256(map));
  MapCopy accepted = map;
  accepted.closures = {closure(0, ClosureState::accepted)};
  EXPECT_NE(map_sha256(accepted), map_sha256(map));
}

// A robot that lies alone has no relations that its dropping would take away.
TEST(MapSha256, PatchesThatOperatorsHaveDroppedCount) {
  MapCopy map = small_map();
  map.left_out = {PatchId{1}};
  EXPECT_NE(map_sha256(map), map_sha256(small_map()));
  MapCopy another = small_map();
  another.left_out = {PatchId{2}};
  EXPECT_NE(map_sha256(another), map_sha256(map));
}

TEST(MapSha256, WhatItCostAndWhatWasDroppedAreNoPartOfTheMap) {
  MapCopy map = small_map();
  map.counters.dropped[DropReason::unknown_robot] = 5;
  map.sessions.clear();
  EXPECT_EQ(map_sha256(map), map_sha256(small_map()));
}

}  // namespace
}  // namespace isthmus
