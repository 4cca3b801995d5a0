#include "server/paths/ground/ground.hpp"

#include <gtest/gtest.h>

#include "server/paths/ground/ground_keeper.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::Seen;
using testing::Spiral;

std::shared_ptr<const Ground> ground_of(const Map& map) {
  GroundKeeper keeper;
  keeper.update(testing::copy_of(map));
  return keeper.ground(IslandId{0});
}

std::size_t layers_at(const Ground& ground, const Eigen::Vector2d& point) {
  const auto [first, last] = ground.at(cell_of(point));
  return static_cast<std::size_t>(last - first);
}

TEST(Ground, TheNearestPatchThatSeesACellLeadsItsLayer) {
  Map map;
  testing::add_round_way(map, testing::furnished_room(), {{-1, 0, 0}, {1, 0, 0}});
  const auto ground = ground_of(map);
  EXPECT_EQ(ground->layer(ground->at(cell_of({-0.5, -1})).first).leader, PatchId{0});
  EXPECT_EQ(ground->layer(ground->at(cell_of({0.5, -1})).first).leader, PatchId{1});
}

TEST(Ground, ACorridorThatLiesOnItselfHasTwoLayersUntilItsLoopIsClosed) {
  Spiral spiral;
  const Eigen::Vector2d on_second_lap = position(spiral.map.manifold().pose(PatchId{20}));
  EXPECT_EQ(layers_at(*ground_of(spiral.map), on_second_lap), 2U);
  spiral.close(20);
  EXPECT_EQ(layers_at(*ground_of(spiral.map), on_second_lap), 1U);
}

TEST(Ground, OneStepsWithinOnesOwnLayer) {
  const Spiral spiral;
  const auto ground = ground_of(spiral.map);
  const Cell cell = cell_of(position(spiral.map.manifold().pose(PatchId{20})));
  const auto [first, last] = ground->at(cell);
  ASSERT_EQ(last - first, 2);
  const NodeId a = ground->step(first, {cell.x + 1, cell.y}),
               b = ground->step(first + 1, {cell.x + 1, cell.y});
  EXPECT_NE(a, b);
  EXPECT_LT(std::abs(ground->layer(a).leader.value - ground->layer(first).leader.value), 3);
  EXPECT_LT(std::abs(ground->layer(b).leader.value - ground->layer(first + 1).leader.value), 3);
}

TEST(Ground, AWallThatOthersSeeThroughIsNoneAndOneThatIsHitStays) {
  testing::Walls with_somebody = testing::furnished_room();
  testing::add_box(with_somebody, 1, -1, 1.3, -0.7);
  Map map;
  map.add(testing::round_patch(with_somebody, PatchId{0}, {}), {});
  for (int i = 1; i <= 5; ++i) {
    map.add(testing::round_patch(testing::furnished_room(), PatchId{i}, {}), {});
    map.relate(testing::odometry_relation(PatchId{i - 1}, PatchId{i}, {}));
  }
  const auto ground = ground_of(map);
  const auto occupied = [&](const Eigen::Vector2d& point) {
    return ground->layer(ground->at(cell_of(point)).first).occupied;
  };
  EXPECT_FALSE(occupied({1.01, -0.8}));
  EXPECT_TRUE(occupied({-2.19, 1.01}) || occupied({-2.21, 1.01}));  // the pillar
}

/// Three patches in a row, of which the outer ones are not near one another. The first and the last see a
/// square 6 m wide each in a layer of its own, the first only its left half; the one in the middle joins them
/// in a strip.
std::shared_ptr<const Ground> half_closed_loop(const Cell& strip_low, const Cell& strip_high) {
  Map map;
  testing::add_round_way(map, testing::furnished_room(), {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  auto tile = std::make_shared<GroundTile>(GroundTile{{0, 0}, {0}, {}});
  for (int y = 0; y < ground_tile_cells; ++y) {
    for (int x = 0; x < ground_tile_cells; ++x) {
      const bool is_strip = x >= strip_low.x && x <= strip_high.x && y >= strip_low.y && y <= strip_high.y;
      if (is_strip) tile->layers.push_back({PatchId{1}});
      if (!is_strip) tile->layers.push_back({PatchId{2}});
      if (!is_strip && x < 60) tile->layers.push_back({PatchId{0}});
      tile->first.push_back(static_cast<std::uint32_t>(tile->layers.size()));
    }
  }
  return testing::ground_of(tile, std::make_shared<const NearPatches>(testing::copy_of(map), 1.5));
}

TEST(Ground, WhatOneStretchHasNotSeenIsNotUnseenToAnotherThatHas) {
  const auto ground = half_closed_loop({50, 60}, {58, 62});
  const Cell cell{57, 65};
  const NodeId first = ground->find(cell, PatchId{0}), last = ground->find(cell, PatchId{2});
  ASSERT_NE(first, last);
  EXPECT_LT(ground->unseen_m(first), 0.2);
  EXPECT_NEAR(ground->unseen_m(last), Ground::reach_m, 1e-6);
}

TEST(Ground, DistancesAreToTheNearestWallAndToTheUnseen) {
  const auto ground =
      testing::ground_of(60, [](int x, int) { return x == 10 ? Seen::occupied : Seen::open; });
  const double least = (5 - 0.71) * ground_cell_m;
  EXPECT_NEAR(ground->wall_m(testing::node_at(*ground, 15, 30)), least, 1e-3);
  EXPECT_NEAR(ground->unseen_m(testing::node_at(*ground, 30, 4)), least, 1e-3);
  EXPECT_EQ(ground->wall_m(testing::node_at(*ground, 10, 30)), 0);
  EXPECT_NEAR(ground->wall_m(testing::node_at(*ground, 50, 30)), Ground::reach_m, 1e-6);
}

TEST(Ground, NothingIsKnownOutside) {
  const auto ground = testing::ground_of(10, [](int, int) { return Seen::open; });
  for (const Cell& cell : {Cell{10, 5}, Cell{-1, 5}, Cell{5, 100'000}, Cell{-100'000, -3}}) {
    const auto [first, last] = ground->at(cell);
    EXPECT_EQ(first, last) << cell.x << " " << cell.y;
  }
  EXPECT_EQ(ground->step(testing::node_at(*ground, 9, 5), {10, 5}), -1);
}

}  // namespace
}  // namespace isthmus
