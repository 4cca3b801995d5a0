#include "server/engine/places/recent_way.hpp"

#include <gtest/gtest.h>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

TEST(RecentWay, OfNoPatchHasNoLength) { EXPECT_EQ(RecentWay{}.length_m(), 0); }

TEST(RecentWay, LeavesOutWhatIsFartherBackThanItHolds) {
  RecentWay way;
  way.add(PatchId{0}, 0, 8);
  way.add(PatchId{1}, 3, 8);
  way.add(PatchId{2}, 5, 8);
  EXPECT_EQ(way.length_m(), 8);
  EXPECT_EQ(way.newest_first, (std::deque{PatchId{2}, PatchId{1}, PatchId{0}}));
  way.add(PatchId{3}, 1, 8);
  EXPECT_EQ(way.length_m(), 6) << "9 m back is one too far";
  EXPECT_EQ(way.newest_first, (std::deque{PatchId{3}, PatchId{2}, PatchId{1}}));
  EXPECT_EQ(way.from_newest_m, (std::deque<double>{0, 1, 6}));
}

// As they were while it drove: every two metres, once there are five, of eight metres at most.
TEST(PiecesOfAWay, AreThoseThatWereSearchedForWhileItWasDriven) {
  Map map;
  std::vector<Pose> way;
  for (int i = 0; i <= 12; ++i) way.push_back({1.0 * i, 0, 0});
  const std::vector<PatchId> patches = testing::add_way(map, testing::furnished_room(), way);
  const auto pieces = pieces_along(map.manifold(), patches, {});
  ASSERT_EQ(pieces.size(), 4U) << "at 5, 7, 9 and 11 m";
  EXPECT_EQ(pieces[0].front(), patches[5]);
  EXPECT_EQ(pieces[0].back(), patches[0]);
  EXPECT_EQ(pieces[3].front(), patches[11]);
  EXPECT_EQ(pieces[3].back(), patches[3]) << "8 m back";
}

TEST(PiecesOfAWay, DoNotReachAcrossGroundOnWhichTheRobotMadeNoPatches) {
  Map map;
  std::vector<Pose> way;
  for (int i = 0; i <= 5; ++i) way.push_back({1.0 * i, 0, 0});
  for (int i = 0; i <= 5; ++i) way.push_back({20 + 1.0 * i, 0, 0});
  const std::vector<PatchId> patches = testing::add_way(map, testing::furnished_room(), way);
  const auto pieces = pieces_along(map.manifold(), patches, {});
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_EQ(pieces[1].size(), 6U);
  EXPECT_EQ(pieces[1].back(), patches[6]);
}

}  // namespace
}  // namespace isthmus
