#include "tools/simulate/campaigns/paths/grid_optimum.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace isthmus {
namespace {

/// 5 m by 5 m of free cells, with a wall at x = 2.5 m from the lower end to y = 3 m.
OccupancyGrid grid_with_wall() {
  OccupancyGrid grid;
  grid.width = grid.height = 100;
  grid.pixels.assign(10'000, OccupancyGrid::free);
  for (int y = 0; y < 60; ++y)
    grid.pixels[static_cast<std::size_t>((99 - y) * 100 + 50)] = OccupancyGrid::occupied;
  return grid;
}

TEST(GridOptimum, WaysOverOpenGroundAreStraight) {
  GridOptimum optimum(grid_with_wall(), {0.1, 0});
  optimum.start_from({10, 80});
  EXPECT_NEAR(optimum.length_m({90, 80}), 4, 1e-4);
  EXPECT_NEAR(optimum.length_m({80, 93}), std::hypot(70, 13) * ground_cell_m, 0.008 * 3.6);
}

TEST(GridOptimum, WaysGoRoundWallsAndNotOverThem) {
  GridOptimum optimum(grid_with_wall(), {0, 0});
  optimum.start_from({20, 20});
  EXPECT_GE(optimum.length_m({80, 20}), 2 * std::hypot(30, 40) * ground_cell_m);
  EXPECT_LE(optimum.length_m({80, 20}), 1.01 * 2 * std::hypot(30, 42) * ground_cell_m);
}

TEST(GridOptimum, ThereIsRoomAsFarFromWallsAsAsked) {
  const GridOptimum optimum(grid_with_wall(), {0.2, 0.1});
  EXPECT_TRUE(optimum.has_room({42, 20}));
  EXPECT_FALSE(optimum.has_room({43, 20}));
  EXPECT_FALSE(optimum.has_room({-1, 20}));
}

TEST(GridOptimum, APointIsNearAWallByTheWallsCellAndNotByItsCentre) {
  const GridOptimum optimum(grid_with_wall(), {0.1, 0});
  EXPECT_TRUE(optimum.is_near_wall({2.31, 1}, 0.2));  // the wall begins at 2.5
  EXPECT_FALSE(optimum.is_near_wall({2.29, 1}, 0.2));
  EXPECT_TRUE(optimum.is_occupied({50, 20}));
  EXPECT_FALSE(optimum.is_occupied({49, 20}));
}

}  // namespace
}  // namespace isthmus
