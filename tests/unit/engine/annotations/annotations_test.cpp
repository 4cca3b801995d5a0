#include "server/engine/annotations/annotations.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "server/engine/annotations/annotation.hpp"
#include "server/engine/annotations/annotation_limits.hpp"
#include "server/engine/input/annotation_kind.hpp"
#include "tests/support/zones.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;
using Kind = AnnotationKind;

void expect_points(const std::vector<Eigen::Vector2d>& points, const std::vector<Eigen::Vector2d>& expected) {
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT((points[i] - expected[i]).norm(), 1e-9) << i << ": " << points[i].transpose();
}

// A line of ten patches, with what operators write on it.
struct Drawn {
  DropReason take(const AnnotationEvent& event) { return annotations.take(event, map, is_on_map); }
  DropReason draw(Kind kind, const std::string& name, const std::vector<Eigen::Vector2d>& points) {
    return take(annotation(kind, name, line.front(), points));
  }
  AnnotationRecord only() const {
    const auto records = annotations.records(map, is_on_map);
    EXPECT_EQ(records.size(), 1U);
    return records.front();
  }
  std::vector<Eigen::Vector2d> points() const { return placed(map, only()); }

  Map map;
  std::vector<PatchId> line = add_line(map, 10);
  Annotations annotations;
  IsOnMap is_on_map = on_any_map;
};

// Corners go with their patches, the place faces where it did.
TEST(Annotations, MoveWithTheMap) {
  Drawn on;
  EXPECT_EQ(on.draw(Kind::keep_out, "stairs", rectangle(1, 1, 3, 2)), DropReason::none);
  AnnotationEvent dock = annotation(Kind::place, "Dock 1", on.line.front(), {{5, 1}});
  dock.yaw_rad = 0.5;
  EXPECT_EQ(on.take(dock), DropReason::none);
  const Pose moved{10, -2, std::numbers::pi / 2};
  on.map.move_island(on.line.front(), moved);
  const auto records = on.annotations.records(on.map, on.is_on_map);
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].name, "Dock 1") << "by name";
  expect_points(placed(on.map, records[0]), {moved * Eigen::Vector2d(5, 1)});
  EXPECT_NEAR(on.map.manifold().project(records[0].points[0]).yaw, 0.5 + std::numbers::pi / 2, 1e-9);
  expect_points(placed(on.map, records[1]), {{9, -1}, {9, 1}, {8, 1}, {8, -1}});
  EXPECT_EQ(records[1].moved, 0);
}

TEST(Annotations, HoldOnToTheNearestPatches) {
  Drawn on;
  on.draw(Kind::keep_out, "z", rectangle(0.9, 1, 7.2, 2));
  const AnnotationRecord zone = on.only();
  const std::vector<PatchId> patches = {zone.points[0].patch, zone.points[1].patch, zone.points[2].patch,
                                        zone.points[3].patch};
  EXPECT_EQ(patches, (std::vector<PatchId>{on.line[1], on.line[7], on.line[7], on.line[1]}));
}

TEST(Annotations, MidwayBetweenTwoPatchesAreHeldByTheOlder) {
  Drawn on;
  on.draw(Kind::place, "p", {{2.5, 1}});
  EXPECT_EQ(on.only().points.front().patch, on.line[2]);
}

TEST(Annotations, MayBeDrawnEitherWayRound) {
  Drawn on;
  EXPECT_EQ(on.draw(Kind::keep_out, "a", {{0, 0}, {1, 0}, {1, 1}}), DropReason::none);
  EXPECT_EQ(on.draw(Kind::keep_out, "b", {{0, 0}, {1, 1}, {1, 0}}), DropReason::none);
}

TEST(Annotations, OfAnIslandWhosePatchIsNotOnTheMapAreRefused) {
  Drawn on;
  on.is_on_map = [&](PatchId id) { return id != on.line.front(); };
  EXPECT_EQ(on.draw(Kind::place, "p", {{2, 1}}), DropReason::unknown_patch);
}

// Half of its corners are on each of two islands: it stays with the older, and of the others' corners each is
// told from the nearest of those that stayed.
TEST(Annotations, StayWithTheOlderIslandWhereHalfOfTheCornersPart) {
  Drawn on;
  on.draw(Kind::keep_out, "z", {{0, 1}, {9, 1}, {9, 2}, {3, 2}});
  std::vector<RelationId> gone;
  for (const RelationId id : on.map.graph().between(on.line[6], on.line[7])) gone.push_back(id);
  on.map.remove(gone);
  on.map.move_island(on.line[7], {100, 0, 1});
  on.map.move_island(on.line.front(), {0, 3, 0});
  const AnnotationRecord zone = on.only();
  EXPECT_EQ(zone.island, on.line.front());
  EXPECT_EQ(zone.moved, 2);
  EXPECT_EQ(zone.points[1].patch, on.line[3]) << "the nearer of the corners that stayed";
  expect_points(placed(on.map, zone), {{0, 4}, {9, 4}, {9, 5}, {3, 5}});
}

TEST(Annotations, MayBeGivenInTheFramesOfPatches) {
  Drawn on;
  on.map.move_island(on.line.front(), {0, 0, std::numbers::pi / 2});
  AnnotationEvent event = annotation(Kind::place, "p", IslandId{}, {{0, 1}});
  event.points.front().patch = on.line[4];
  EXPECT_EQ(on.take(event), DropReason::none);
  expect_points(on.points(), {{-1, 4}});
  event = annotation(Kind::keep_out, "z", IslandId{}, rectangle(0, 0, 1, 1));
  const auto other = add_line(on.map, 2);
  for (auto& point : event.points) point.patch = on.line[4];
  event.points.back().patch = other.front();
  EXPECT_EQ(on.take(event), DropReason::other_island);
  event.points.back().patch = PatchId{99};
  EXPECT_EQ(on.take(event), DropReason::unknown_patch);
}

TEST(Annotations, AreRefusedWithTheReason) {
  Drawn on;
  EXPECT_EQ(on.draw(Kind::keep_out, "bow", {{0, 0}, {2, 2}, {2, 0}, {0, 2}}), DropReason::bad_polygon);
  EXPECT_EQ(on.draw(Kind::speed, "flat", {{0, 0}, {1, 0}, {2, 0}}), DropReason::bad_polygon);
  EXPECT_EQ(on.draw(Kind::speed, "tiny", {{0, 0}, {0.05, 0}, {0, 0.05}}), DropReason::bad_polygon);
  EXPECT_EQ(on.draw(Kind::place, "far", {{0, 51}}), DropReason::off_the_map);
  EXPECT_EQ(on.take(annotation(Kind::place, "p", on.line[1], {{0, 0}})), DropReason::unknown_patch)
      << "no island's lowest patch";
  EXPECT_EQ(on.take(annotation(Kind::place, "p", PatchId{99}, {{0, 0}})), DropReason::unknown_patch);
  EXPECT_EQ(on.draw(Kind::erase, "p", {}), DropReason::no_such_name);
  EXPECT_TRUE(on.annotations.empty());
}

TEST(Annotations, HaveNamesOfTheirOwnWhateverTheCase) {
  Drawn on;
  EXPECT_EQ(on.draw(Kind::place, "Dock", {{0, 0}}), DropReason::none);
  EXPECT_EQ(on.draw(Kind::keep_out, "DOCK", rectangle(0, 0, 1, 1)), DropReason::name_taken);
  AnnotationEvent again = annotation(Kind::keep_out, "dock", on.line.front(), rectangle(0, 0, 1, 1));
  again.replace = true;
  EXPECT_EQ(on.take(again), DropReason::none);
  EXPECT_EQ(on.only().kind, Kind::keep_out);
  EXPECT_EQ(on.draw(Kind::erase, "dOcK", {}), DropReason::none);
  EXPECT_TRUE(on.annotations.empty());
}

TEST(Annotations, AreBounded) {
  Drawn on;
  AnnotationLimits limits;
  limits.annotations = 2;
  limits.corners = 4;
  on.annotations = Annotations(limits);
  EXPECT_EQ(on.draw(Kind::keep_out, "z", {{0, 0}, {1, 0}, {2, 1}, {1, 2}, {0, 1}}), DropReason::bad_polygon);
  on.draw(Kind::place, "a", {{0, 0}});
  on.draw(Kind::place, "b", {{0, 0}});
  EXPECT_EQ(on.draw(Kind::place, "c", {{0, 0}}), DropReason::too_many_annotations);
  AnnotationEvent again = annotation(Kind::place, "a", on.line.front(), {{1, 0}});
  again.replace = true;
  EXPECT_EQ(on.take(again), DropReason::none);
}

// A robot has come back to where it began and does not know it: two stretches lie over one another.
//
//      0 --- 1 --- 2 ... 30 patches ... 31 --- 32 --- 33 (where 0, 1, 2 are)
//
// A zone drawn there holds on to one of them: were it torn apart, the closing of the loop would do it.
TEST(Annotations, HoldOnToOneStretchOfTheMap) {
  Map map;
  std::vector<Pose> poses;
  for (int i = 0; i < 4; ++i) poses.push_back({1.0 * i, 0, 0});
  for (int i = 0; i < 20; ++i) poses.push_back({4 + 1.5 * i, 3, 0});
  for (int i = 0; i < 20; ++i) poses.push_back({32 - 1.5 * i, 6, 0});
  for (int i = 0; i < 4; ++i) poses.push_back({3.4 - i, 0.4, 0});
  Walls room;
  add_box(room, -5, -5, 40, 12);
  const auto way = add_way(map, room, poses);
  Annotations annotations;
  ASSERT_EQ(
      annotations.take(annotation(AnnotationKind::keep_out, "z", way.front(), rectangle(0, -0.2, 3.4, 0.6)),
                       map, on_any_map),
      DropReason::none);
  const std::vector<AnnotationRecord> records = annotations.records(map, on_any_map);
  for (const ManifoldPose& corner : records.front().points) EXPECT_LT(corner.patch, way[4]);
}

// Patches 0 to 6 stay together; 7 to 9 part from them and are moved away.
TEST(Annotations, KeepTheirShapeWhereTheirIslandParts) {
  Drawn on;
  on.draw(Kind::keep_out, "z", {{0, 1}, {4, 1}, {9, 1}, {9, 2}, {4, 2}, {0, 2}});
  std::vector<RelationId> gone;
  for (const RelationId id : on.map.graph().between(on.line[6], on.line[7])) gone.push_back(id);
  on.map.remove(gone);
  on.map.move_island(on.line[7], {100, 0, 1});
  const AnnotationRecord zone = on.only();
  EXPECT_EQ(zone.island, on.line.front());
  EXPECT_EQ(zone.moved, 2);
  EXPECT_FALSE(zone.lost);
  expect_points(placed(on.map, zone), {{0, 1}, {4, 1}, {9, 1}, {9, 2}, {4, 2}, {0, 2}});
}

// R2 mapped the middle: what its patches hold is held by R1's from then on.
TEST(Annotations, LeaveARobotWhoseDataIsDropped) {
  Map map;
  const auto line = add_line(map, 3, 0, "R1");
  const auto others = add_line(map, 3, 3, "R2");
  map.relate(odometry_relation(line[2], others[0], {1, 0, 0}));
  Annotations annotations;
  annotations.take(annotation(AnnotationKind::keep_out, "z", line.front(), rectangle(4, 1, 5, 2)), map,
                   on_any_map);
  const IsOnMap without_r2 = [&](PatchId id) { return map.manifold().patch(id).robot != "R2"; };
  EXPECT_TRUE(annotations.records(map, without_r2).front().lost);
  EXPECT_FALSE(annotations.records(map, on_any_map).front().lost)
      << "where its data comes back, so does the zone";
  map.move_island(line.front(), {0, 7, 0});  // since it was drawn
  annotations.leave("R2", map, on_any_map);
  const AnnotationRecord zone = annotations.records(map, without_r2).front();
  EXPECT_FALSE(zone.lost);
  EXPECT_EQ(zone.points.front().patch, line[2]);
  expect_points(placed(map, zone), rectangle(4, 8, 5, 9));
}

TEST(Annotations, AreHeldByNoTags) {
  Drawn on;
  auto tag = std::make_shared<Patch>();
  tag->id = on.map.manifold().next_id();
  tag->tag = 7;
  on.map.add(tag, {2.1, 1, 0});
  on.map.relate(odometry_relation(on.line[2], tag->id, {0.1, 1, 0}));
  on.draw(Kind::place, "p", {{2.1, 1}});
  EXPECT_EQ(on.only().points.front().patch, on.line[2]);
}

// What a damaged snapshot may hold.
TEST(Annotation, IsSoundIfItCouldHaveBeenDrawn) {
  const Anchor anchor{PatchId{0}, {}, {1, 0}};
  const Annotation zone{Kind::speed, "z", 0.5, 0, {anchor, anchor, anchor}};
  EXPECT_TRUE(zone.is_sound());
  EXPECT_TRUE((Annotation{Kind::place, "p", 0, 1, {anchor}}.is_sound()));
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto is_sound = [&](const auto& change) {
    Annotation one = zone;
    change(one);
    return one.is_sound();
  };
  EXPECT_FALSE(is_sound([](Annotation& one) { one.kind = Kind::erase; }));
  EXPECT_FALSE(is_sound([](Annotation& one) { one.kind = Kind::place; })) << "of three points";
  EXPECT_FALSE(is_sound([](Annotation& one) { one.anchors.pop_back(); }));
  EXPECT_FALSE(is_sound([](Annotation& one) { one.name = "<b>"; }));
  EXPECT_FALSE(is_sound([](Annotation& one) { one.max_speed_m_s = nan; }));
  EXPECT_FALSE(is_sound([](Annotation& one) { one.drawn_yaw_rad = nan; }));
  EXPECT_FALSE(is_sound([](Annotation& one) { one.anchors[2].drawn.y() = nan; }));
  EXPECT_FALSE(is_sound([](Annotation& one) { one.anchors[1].drawn_from_patch.yaw = nan; }));
}

// Two robots drew on maps of their own; then they meet.
TEST(Annotations, AreOnTheIslandThatTheirsMergedInto) {
  Drawn on;
  on.draw(Kind::keep_out, "a", rectangle(4, 1, 5, 2));
  const auto other = add_line(on.map, 4, 0, "R2");
  ASSERT_EQ(on.take(annotation(Kind::keep_out, "b", other.front(), rectangle(1, 1, 2, 2))), DropReason::none);
  EXPECT_EQ(on.annotations.records(on.map, on.is_on_map)[1].island, other.front());
  on.map.move_island(other.front(), {20, 5, 0});
  on.map.relate(odometry_relation(on.line.back(), other.front(), {11, 5, 0}));
  const auto records = on.annotations.records(on.map, on.is_on_map);
  ASSERT_EQ(records.size(), 2U);
  for (const AnnotationRecord& record : records) EXPECT_EQ(record.island, on.line.front());
  expect_points(placed(on.map, records[1]), rectangle(21, 6, 22, 7));
  EXPECT_EQ(on.take(annotation(Kind::place, "p", other.front(), {{1, 1}})), DropReason::unknown_patch)
      << "an island that is no more";
}

TEST(AnnotationName, IsShortAndHarmless) {
  for (const char* name : {"A", "Dock 3", "2.OG-links_b"}) EXPECT_TRUE(is_annotation_name(name)) << name;
  for (const char* name : {"", " a", "a ", "-a", "a/b", "a\n", "<b>", "ä"})
    EXPECT_FALSE(is_annotation_name(name)) << name;
  EXPECT_TRUE(is_annotation_name(std::string(48, 'a')));
  EXPECT_FALSE(is_annotation_name(std::string(49, 'a')));
}

}  // namespace
}  // namespace isthmus
