#include "server/wire/live/rendezvous_publisher.hpp"

#include <gtest/gtest.h>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace std::chrono_literals;

const std::chrono::steady_clock::time_point first_due{1000s};

MapCopy map_with_meeting() {
  MapCopy map;
  for (int i = 0; i < 2; ++i) {
    map.patches.push_back(testing::patch_from(testing::furnished_room(), PatchId{i}, {}));
    map.poses.push_back({});
    map.graph.add_patch(PatchId{i});
  }
  map.meeting =
      MeetingRecord{ClosureId{5}, {"R1", {PatchId{0}, {1, 2, 0.5}}}, {"R2", {PatchId{1}, {3, 4, -0.5}}}};
  return map;
}

TEST(RendezvousPublisher, TellsBothPlaces) {
  RendezvousPublisher publisher;
  const auto message = publisher.due(map_with_meeting(), 77, first_due);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->utime, 77);
  EXPECT_EQ(message->closure, 5);
  EXPECT_EQ(message->robot_a, "R1");
  EXPECT_EQ(message->patch_a, 0);
  EXPECT_EQ(message->island_a, 0);
  EXPECT_EQ(message->patch_a_from_meeting[1], 2);
  EXPECT_EQ(message->robot_b, "R2");
  EXPECT_EQ(message->patch_b, 1);
  EXPECT_EQ(message->island_b, 1);
  EXPECT_EQ(message->patch_b_from_meeting[2], -0.5);
}

TEST(RendezvousPublisher, SpeaksWhenTheMeetingChangesAndNowAndThen) {
  RendezvousPublisher publisher;
  MapCopy map = map_with_meeting();
  EXPECT_FALSE(publisher.due(MapCopy{}, 0, first_due));
  EXPECT_TRUE(publisher.due(map, 0, first_due + 1s));
  EXPECT_FALSE(publisher.due(map, 0, first_due + 2s));
  map.meeting->b.pose.patch_from_object.x += 0.5;
  EXPECT_TRUE(publisher.due(map, 0, first_due + 3s));
  EXPECT_FALSE(publisher.due(map, 0, first_due + 5s));
  EXPECT_TRUE(publisher.due(map, 0, first_due + 6s));
  map.meeting.reset();
  EXPECT_FALSE(publisher.due(map, 0, first_due + 7s));
}

}  // namespace
}  // namespace isthmus
