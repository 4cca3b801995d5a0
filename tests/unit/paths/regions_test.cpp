#include "server/paths/roads/regions.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/paths/roads/roadmap.hpp"
#include "server/paths/roads/route.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::node_at;
using testing::Seen;

constexpr Footprint bare_footprint{0.1, 0.0};

/// 6 m square; a wall at x = 3 m with a doorway at its lower end and, if `both`, one at its upper end.
Roadmap rooms(bool both) {
  return Roadmap(testing::ground_of(120,
                                    [both](int x, int y) {
                                      const bool door = y < 14 || (both && y >= 106);
                                      return x == 60 && !door ? Seen::occupied : Seen::open;
                                    }),
                 bare_footprint);
}

float left_m(const Roadmap& roadmap, int from_y, int x, int y) {
  const Ground& ground = roadmap.ground();
  const auto square = [&](int at_x, int at_y) { return roadmap.square(node_at(ground, at_x, at_y)); };
  const std::vector<float> left = roadmap.regions().left_m(square(20, from_y), square(100, from_y));
  return left.at(static_cast<std::size_t>(roadmap.regions().of(square(x, y))));
}

TEST(Regions, WhatIsLeftIsHardlyMoreThanTheWay) {
  const Roadmap roadmap = rooms(false);
  const double way_m = 2 * std::hypot(40, 53) * ground_cell_m;
  EXPECT_LE(left_m(roadmap, 60, 20, 60), 1.08 * way_m);
  EXPECT_GE(left_m(roadmap, 60, 20, 60), 0.85 * way_m);
}

TEST(Regions, AWayThatIsMuchLongerIsLeftOut) {
  const Roadmap roadmap = rooms(true);
  EXPECT_TRUE(std::isfinite(left_m(roadmap, 60, 60, 7)));  // both doors are as near
  EXPECT_TRUE(std::isfinite(left_m(roadmap, 60, 60, 112)));
  EXPECT_TRUE(std::isfinite(left_m(roadmap, 10, 60, 7)));
  EXPECT_FALSE(std::isfinite(left_m(roadmap, 10, 60, 112)));  // ten metres, past the door that is near
}

TEST(Regions, RoomsWithoutADoorHaveNoWayAndNoSearchIsMade) {
  const Roadmap roadmap(
      testing::ground_of(60, [](int x, int) { return x == 30 ? Seen::occupied : Seen::open; }),
      bare_footprint);
  const NodeId from = node_at(roadmap.ground(), 10, 10), to = node_at(roadmap.ground(), 50, 10);
  EXPECT_TRUE(roadmap.regions().left_m(roadmap.square(from), roadmap.square(to)).empty());
  EXPECT_FALSE(find_route(roadmap, from, to, 100'000));
}

}  // namespace
}  // namespace isthmus
