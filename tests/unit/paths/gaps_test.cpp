#include "server/paths/ground/gaps.hpp"

#include <gtest/gtest.h>

#include "server/paths/questions/frontiers.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::ground_of;
using testing::node_at;
using testing::Seen;

constexpr int side = 60;

/// Free ground with a square of cells that nobody has seen in the middle, from 30 to before 30 + `gap`.
std::shared_ptr<const Ground> ground_with(int gap, Seen at_rim = Seen::open) {
  return ground_of(side, [=](int x, int y) {
    if (x == 29 && y == 32) return at_rim;
    const bool inside = x >= 30 && x < 30 + gap && y >= 30 && y < 30 + gap;
    return inside ? Seen::nothing : Seen::open;
  });
}

TEST(Gaps, WhatIsNarrowerThanARobotAndFreeAllAroundIsNoUnknownGround) {
  const auto ground = ground_with(6);  // .42 m across
  const NodeId gap = node_at(*ground, 32, 32);
  ASSERT_TRUE(ground->at({32, 32}).second > gap) << "it is a cell of the ground";
  EXPECT_TRUE(ground->layer(gap).is_gap);
  EXPECT_FALSE(ground->layer(gap).occupied);
  EXPECT_FALSE(ground->layer(node_at(*ground, 29, 30)).is_gap);
  EXPECT_EQ(ground->step(node_at(*ground, 29, 30), {30, 30}), node_at(*ground, 30, 30));
  EXPECT_GT(ground->unseen_m(gap), 1);
  const Roadmap roadmap(ground, testing::slim);
  EXPECT_TRUE(roadmap.sees(node_at(*ground, 20, 32), node_at(*ground, 45, 32)));
}

TEST(Gaps, WhatIsLargerIsUnknown) {
  const auto ground = ground_with(8);  // .57 m
  EXPECT_EQ(ground->at({32, 32}).first, ground->at({32, 32}).second);
  EXPECT_LT(ground->unseen_m(node_at(*ground, 29, 31)), 0.1F);
}

TEST(Gaps, WhereSomethingWasHitAtItsRimSomethingMayStandInIt) {
  const auto ground = ground_with(6, Seen::occupied);
  EXPECT_EQ(ground->at({32, 32}).first, ground->at({32, 32}).second);
}

TEST(Gaps, TheEdgeOfTheKnownIsNone) {
  const auto ground = ground_with(6);
  EXPECT_EQ(ground->at({side, 30}).first, ground->at({side, 30}).second);
  const TilesAround filled{{nullptr, nullptr, nullptr, nullptr, ground->surfaces()[0]->tile.get()}};
  EXPECT_EQ(find_gaps(GroundWindow(filled, 0, {})).size(), 0U) << "those that there were are filled";
  FrontierOptions every;
  every.min_gain_m2 = 0;
  for (const Frontier& frontier : find_frontiers(Roadmap(ground, testing::slim), -1, every))
    EXPECT_FALSE(frontier.middle.x() > 1 && frontier.middle.x() < 2 && frontier.middle.y() > 1 &&
                 frontier.middle.y() < 2)
        << "nobody is sent to look into it";
}

}  // namespace
}  // namespace isthmus
