#include "server/paths/roads/roadmap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/paths/ground/ground_keeper.hpp"
#include "server/paths/roads/pull.hpp"
#include "server/paths/roads/route.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::node_at;
using testing::Seen;

constexpr std::size_t steps = 100'000;

/// 5 m square; a wall at x = 2.5 m with a gap from y = 3 m, so many cells wide.
std::shared_ptr<const Ground> wall_with_gap(int gap_cells) {
  return testing::ground_of(100, [gap_cells](int x, int y) {
    return x == 50 && (y < 60 || y >= 60 + gap_cells) ? Seen::occupied : Seen::open;
  });
}

TEST(Roadmap, AFootprintFitsWhereWallsAndTheUnseenAreFarEnough) {
  const Roadmap roadmap(wall_with_gap(12), {0.2, 0.1});
  EXPECT_TRUE(roadmap.fits(node_at(roadmap.ground(), 20, 20)));
  EXPECT_FALSE(roadmap.fits(node_at(roadmap.ground(), 46, 20)));  // 20 cm from the wall
  EXPECT_FALSE(roadmap.fits(node_at(roadmap.ground(), 2, 20)));   // 10 cm from the unseen
  EXPECT_FALSE(roadmap.fits(node_at(roadmap.ground(), 50, 20)));
}

TEST(Roadmap, OneSeesThroughTheGapAndNotThroughTheWall) {
  const Roadmap roadmap(wall_with_gap(12), {0.1, 0.05});
  const Ground& ground = roadmap.ground();
  EXPECT_TRUE(roadmap.sees(node_at(ground, 20, 66), node_at(ground, 80, 66)));
  EXPECT_TRUE(roadmap.sees(node_at(ground, 20, 60), node_at(ground, 80, 72)));
  EXPECT_FALSE(roadmap.sees(node_at(ground, 20, 20), node_at(ground, 80, 20)));
  EXPECT_FALSE(roadmap.sees(node_at(ground, 20, 20), node_at(ground, 80, 90)));
}

TEST(Roadmap, OpenCellsEndWhereTheFootprintDoesNotFit) {
  const Roadmap roadmap(wall_with_gap(12), {0.1, 0.05});
  const Ground& ground = roadmap.ground();
  for (const int x : {20, 30, 40}) {
    const NodeId node = node_at(ground, x, 30);
    const std::int32_t open = roadmap.open_cells(node);
    ASSERT_GT(open, 0);
    bool all = true, more = true;
    for (std::int32_t dy = -open - 1; dy <= open + 1; ++dy) {
      for (std::int32_t dx = -open - 1; dx <= open + 1; ++dx) {
        const NodeId other = node_at(ground, x + dx, 30 + dy);
        const bool within = std::max(std::abs(dx), std::abs(dy)) <= open;
        (within ? all : more) = (within ? all : more) && roadmap.fits(other);
      }
    }
    EXPECT_TRUE(all) << x;
    EXPECT_FALSE(more) << x;
  }
}

TEST(Roadmap, NoCellsAreOpenWhereLayersLieOnOneAnother) {
  const testing::Spiral spiral;
  GroundKeeper keeper;
  keeper.update(testing::copy_of(spiral.map));
  const Roadmap roadmap(keeper.ground(IslandId{0}), {0.1, 0.05});
  const auto at = [&](int patch) {
    return roadmap.ground().find(cell_of(position(spiral.map.manifold().pose(PatchId{patch}))),
                                 PatchId{patch});
  };
  EXPECT_GT(roadmap.open_cells(at(60)), 0);
  EXPECT_EQ(roadmap.open_cells(at(20)), 0);
  EXPECT_EQ(roadmap.open_cells(at(20 + testing::Spiral::lap_patches)), 0);
}

TEST(Route, GoesThroughAGapThatIsWideEnoughOnly) {
  for (const int gap_cells : {8, 12}) {
    const Roadmap roadmap(wall_with_gap(gap_cells), {0.15, 0.05});
    const NodeId from = node_at(roadmap.ground(), 20, 20), to = node_at(roadmap.ground(), 80, 20);
    EXPECT_EQ(find_route(roadmap, from, to, steps).has_value(), gap_cells == 12) << gap_cells;
  }
}

TEST(Route, EachCellIsSeenFromTheOneBefore) {
  const Roadmap roadmap(wall_with_gap(12), {0.1, 0.05});
  const auto route =
      find_route(roadmap, node_at(roadmap.ground(), 20, 20), node_at(roadmap.ground(), 80, 20), steps);
  ASSERT_TRUE(route);
  for (std::size_t i = 1; i < route->size(); ++i) EXPECT_TRUE(roadmap.sees((*route)[i - 1], (*route)[i]));
}

TEST(Route, GivesUpAfterSoManySteps) {
  const Roadmap roadmap(wall_with_gap(12), {0.1, 0.05});
  const NodeId from = node_at(roadmap.ground(), 20, 20), to = node_at(roadmap.ground(), 80, 20);
  EXPECT_FALSE(find_route(roadmap, from, to, 3));
}

TEST(Pull, AWayPulledTautIsHardlyLongerThanTheShortest) {
  const Roadmap roadmap(wall_with_gap(12), {0.1, 0.05});
  const Ground& ground = roadmap.ground();
  const NodeId from = node_at(ground, 20, 20), to = node_at(ground, 80, 20);
  const auto route = find_route(roadmap, from, to, steps);
  ASSERT_TRUE(route);
  const std::vector<NodeId> taut = pull(roadmap, *route);
  // Two tangents and an arc round the wall's end, 5 cells from it: the least whole number asked. Cells that a
  // line only grazes must fit too.
  const double to_end = std::hypot(30, 39), radius = 5;
  const double turn = 2 * (std::numbers::pi - std::atan2(30, 39) - std::acos(radius / to_end));
  const double min_m = (2 * std::sqrt(to_end * to_end - radius * radius) + radius * turn) * ground_cell_m;
  EXPECT_LE(length_m(ground, taut), 1.03 * min_m);
  EXPECT_LE(length_m(ground, taut), length_m(ground, *route));
  EXPECT_EQ(taut.front(), from);
  EXPECT_EQ(taut.back(), to);
}

TEST(Pull, ADetourOverOpenGroundBecomesAStraightLine) {
  const Roadmap roadmap(testing::ground_of(100, [](int, int) { return Seen::open; }), {0.1, 0.05});
  const Ground& ground = roadmap.ground();
  const std::vector<NodeId> detour{node_at(ground, 20, 20), node_at(ground, 30, 70), node_at(ground, 80, 80)};
  EXPECT_EQ(pull(roadmap, detour), (std::vector<NodeId>{detour.front(), detour.back()}));
}

TEST(Costs, GrowAlongTheWayAndAreInfiniteWhereThereIsNone) {
  const Roadmap open(wall_with_gap(12), {0.1, 0.05}), shut(wall_with_gap(2), {0.1, 0.05});
  const NodeId from = node_at(open.ground(), 20, 20), to = node_at(open.ground(), 80, 20);
  const float cost = costs_from(open, from)[static_cast<std::size_t>(open.square(to))];
  EXPECT_GE(cost, 2 * std::hypot(30, 40) * ground_cell_m - 0.3);
  EXPECT_LE(cost, 1.1 * 2 * std::hypot(30, 45) * ground_cell_m);
  EXPECT_EQ(costs_from(shut, from)[static_cast<std::size_t>(shut.square(to))],
            std::numeric_limits<float>::infinity());
}

}  // namespace
}  // namespace isthmus
