#include "server/wire/message/zone_messages.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

/// Two patches on an island, with a place and two zones on the second.
MapCopy map_with_zones() {
  MapCopy map = testing::map_of_islands({{{0, 0, 0}, {2, 1, std::numbers::pi / 2}}});
  const std::vector<ManifoldPose> corners = {
      {PatchId{1}, {1, 0, 0}}, {PatchId{1}, {2, 0, 0}}, {PatchId{0}, {5, 5, 0}}};
  const auto add = [&](AnnotationKind kind, const char* name, double speed, std::size_t points) {
    AnnotationRecord one;
    one.kind = kind;
    one.name = name;
    one.max_speed_m_s = speed;
    one.island = PatchId{0};
    one.points.assign(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(points));
    map.annotations.push_back(one);
  };
  add(AnnotationKind::place, "Dock", 0, 1);
  add(AnnotationKind::speed, "Ramp", 0.4, 3);
  add(AnnotationKind::keep_out, "Stairs", 0, 3);
  return map;
}

TEST(ZoneMessages, TellAllOfEachInItsIslandsFrameAsItLiesNow) {
  const zones_t all = ZoneMessages().whole(map_with_zones(), 42);
  EXPECT_EQ(all.utime, 42);
  ASSERT_EQ(all.nzones, 3);
  const zone_t& place = all.zones[0];
  EXPECT_EQ(place.kind, "place");
  EXPECT_EQ(place.name, "Dock");
  EXPECT_EQ(place.island, 0);
  ASSERT_EQ(place.ncorners, 1);
  EXPECT_NEAR(place.x_m[0], 2, 1e-9);
  EXPECT_NEAR(place.y_m[0], 2, 1e-9);
  EXPECT_NEAR(place.yaw, std::numbers::pi / 2, 1e-9);
  const zone_t& ramp = all.zones[1];
  EXPECT_EQ(ramp.kind, "speed");
  EXPECT_EQ(ramp.max_speed, 0.4);
  EXPECT_EQ(ramp.yaw, 0);
  ASSERT_EQ(ramp.ncorners, 3);
  EXPECT_NEAR(ramp.y_m[1], 3, 1e-9);
  EXPECT_NEAR(ramp.x_m[2], 5, 1e-9);
  EXPECT_EQ(all.zones[2].kind, "keep_out");
}

TEST(ZoneMessages, AreSentAgainWhenAnythingOfThemChangesAndNotElse) {
  ZoneMessages messages;
  MapCopy map = map_with_zones();
  EXPECT_TRUE(messages.changes(map, 1)) << "the first";
  EXPECT_FALSE(messages.changes(map, 2));
  map.poses[1].x += 5e-4;
  EXPECT_FALSE(messages.changes(map, 3)) << "still";
  map.poses[1].x += 6e-4;
  EXPECT_TRUE(messages.changes(map, 4)) << "it creeps";
  map.poses[1].y += 0.01;
  EXPECT_TRUE(messages.changes(map, 5));
  map.annotations[0].points[0].patch_from_object.yaw += 0.01;
  EXPECT_TRUE(messages.changes(map, 6)) << "the place is turned";
  map.annotations[1].max_speed_m_s = 0.5;
  EXPECT_TRUE(messages.changes(map, 7));
  map.annotations[2].points.pop_back();
  EXPECT_TRUE(messages.changes(map, 8));
  map.annotations[2].kind = AnnotationKind::speed;
  EXPECT_TRUE(messages.changes(map, 9));
  map.annotations[2].island = PatchId{1};
  EXPECT_TRUE(messages.changes(map, 10));
  map.annotations[2].name = "STAIRS";
  EXPECT_TRUE(messages.changes(map, 11));
  EXPECT_FALSE(messages.changes(map, 12));
  map.annotations.clear();
  const auto none = messages.changes(map, 13);
  ASSERT_TRUE(none) << "that there are none is told";
  EXPECT_EQ(none->nzones, 0);
}

TEST(ZoneMessages, LeaveOutWhatIsLostUntilItIsThereAgain) {
  ZoneMessages messages;
  MapCopy map = map_with_zones();
  const std::int32_t id = messages.whole(map, 1).zones[1].id;
  map.annotations[1].lost = true;
  const auto without = messages.changes(map, 2);
  ASSERT_TRUE(without);
  EXPECT_EQ(without->nzones, 2);
  map.annotations[1].lost = false;
  EXPECT_EQ(messages.changes(map, 3)->zones[1].id, id);
}

TEST(ZoneMessages, KeepTheirIdsWhateverIsDrawnOrErasedBesideThem) {
  ZoneMessages messages;
  MapCopy map = map_with_zones();
  const zones_t before = messages.whole(map, 1);
  EXPECT_NE(before.zones[0].id, before.zones[1].id);
  EXPECT_NE(before.zones[1].id, before.zones[2].id);
  map.annotations.erase(map.annotations.begin());
  map.annotations[0].name = "RAMP";
  const zones_t after = messages.whole(map, 2);
  EXPECT_EQ(after.zones[0].id, before.zones[1].id) << "case does not tell two apart";
  EXPECT_EQ(after.zones[1].id, before.zones[2].id);
  map.annotations[1].name = "Door";
  const std::int32_t fresh = messages.whole(map, 3).zones[1].id;
  for (const zone_t& zone : before.zones) EXPECT_NE(fresh, zone.id) << "an id is of one name";
}

}  // namespace
}  // namespace isthmus
