#include "server/engine/places/recent_way.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace isthmus
