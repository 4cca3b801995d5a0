#include "server/output/grid/grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

using testing::map_of;
using testing::rectangle;
using testing::Wall;

std::uint8_t at(const OccupancyGrid& grid, double x, double y) {
  const int column = static_cast<int>(std::floor((x - grid.origin_x_m) / grid.resolution_m));
  const int row_up = static_cast<int>(std::floor((y - grid.origin_y_m) / grid.resolution_m));
  if (column < 0 || column >= grid.width || row_up < 0 || row_up >= grid.height) return 205;
  const int row = grid.height - 1 - row_up;
  return grid.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.width) +
                     static_cast<std::size_t>(column)];
}

std::vector<PatchId> all_of(const MapCopy& map) {
  std::vector<PatchId> ids;
  for (const PatchPtr& patch : map.patches) ids.push_back(patch->id);
  return ids;
}

// A room of 6 m by 4 m, its walls in the middles of cells:
//
//      +--------------------+ 4.025
//      |    R     R     R   |
//      +--------------------+ 0.025
//    0.025                6.025
TEST(Grid, ARoomHasWallsWhereTheyAreFreeInsideAndUnknownOutside) {
  const std::vector<Wall> walls = rectangle(0.025, 0.025, 6.025, 4.025);
  const MapCopy map = map_of(walls, {{1.5, 2, 0.3}, {3, 2.2, 1.0}, {4.5, 1.8, -2.0}});
  const OccupancyGrid grid = render_island(map, all_of(map), 0.05);

  int wall_cells = 0;
  for (double x = 0.125; x < 6; x += 0.05) {
    for (const double y : {0.025, 4.025}) {
      EXPECT_EQ(at(grid, x, y), 0) << x << " " << y;
      ++wall_cells;
    }
  }
  for (double y = 0.125; y < 4; y += 0.05) {
    for (const double x : {0.025, 6.025}) EXPECT_EQ(at(grid, x, y), 0) << x << " " << y;
  }
  EXPECT_GT(wall_cells, 200);
  for (double x = 0.125; x < 5.95; x += 0.05) {
    for (double y = 0.125; y < 3.95; y += 0.05) ASSERT_EQ(at(grid, x, y), 254) << x << " " << y;
  }
  for (const double out : {0.1, 0.15, 0.5}) {
    EXPECT_EQ(at(grid, 3, -out), 205);
    EXPECT_EQ(at(grid, 3, 4.05 + out), 205);
    EXPECT_EQ(at(grid, -out, 2), 205);
    EXPECT_EQ(at(grid, 6.05 + out, 2), 205);
  }
  // The walls are lines: one cell thick but for the corners.
  EXPECT_LE(std::count(grid.pixels.begin(), grid.pixels.end(), 0), 2 * (121 + 81) + 20);
}

TEST(Grid, TheFirstRowIsTheTopAndTheOriginTheLowerLeftCorner) {
  // A wall at the top only: its cells are in the first rows.
  const MapCopy map = map_of({{{-1, 2.025}, {1, 2.025}}}, {{0, 0, 0}});
  const OccupancyGrid grid = render_island(map, all_of(map), 0.05);
  const auto first_wall = std::find(grid.pixels.begin(), grid.pixels.end(), 0) - grid.pixels.begin();
  EXPECT_LT(first_wall / grid.width, 6);
  EXPECT_EQ(at(grid, 0, 2.025), 0);
  EXPECT_LE(grid.origin_y_m, 0);
  EXPECT_NEAR(grid.origin_y_m + grid.height * grid.resolution_m, 2.05, 0.3);
}

TEST(Grid, CellsLieOnMultiplesOfTheResolution) {
  const MapCopy map = map_of(rectangle(0.01, 0.017, 3.3, 2.9), {{1.234, 1.111, 0.7}});
  const OccupancyGrid grid = render_island(map, all_of(map), 0.05);
  EXPECT_NEAR(std::remainder(grid.origin_x_m, 0.05), 0, 1e-12);
  EXPECT_NEAR(std::remainder(grid.origin_y_m, 0.05), 0, 1e-12);
}

TEST(Grid, FreeSpaceEndsWhereThePatchesFreeSpaceIsCut) {
  PatchOptions options;
  options.free_space.max_range_m = 2;
  const MapCopy map = map_of(rectangle(-5, -5, 5, 5), {{0, 0, 0}}, options);
  const OccupancyGrid grid = render_island(map, all_of(map), 0.05);
  EXPECT_EQ(at(grid, 1.9, 0.01), 254);
  EXPECT_EQ(at(grid, 2.1, 0.01), 205);
  EXPECT_EQ(at(grid, 5.0, 0.01), 205) << "a hit beyond the cut is not drawn either";
}

TEST(Grid, BeamsWithoutReturnOpenNothingUnlessTheOptionsSaySo) {
  const std::vector<Wall> one_wall = {{{1.025, -1}, {1.025, 1}}};
  const MapCopy none = map_of(one_wall, {{0, 0, 0}});
  EXPECT_EQ(at(render_island(none, all_of(none), 0.05), 0.5, 0.01), 254);
  EXPECT_EQ(at(render_island(none, all_of(none), 0.05), -0.5, 0.01), 205);

  PatchOptions options;
  options.free_space.no_return_range_m = 0.8;
  const MapCopy some = map_of(one_wall, {{0, 0, 0}}, options);
  EXPECT_EQ(at(render_island(some, all_of(some), 0.05), -0.5, 0.01), 254);
  EXPECT_EQ(at(render_island(some, all_of(some), 0.05), -0.9, 0.01), 205);
}

TEST(Grid, APasserBySeenOnceIsClearedByManyWhoSeeThrough) {
  const std::vector<Wall> room = rectangle(0.025, 0.025, 6.025, 4.025);
  std::vector<Wall> with_person = room;
  for (const Wall& side : rectangle(4.4, 1.9, 4.6, 2.1)) with_person.push_back(side);

  std::vector<Pose> poses(8, Pose{2, 2, 0});
  MapCopy map = map_of(room, poses);
  map.patches[3] =
      make_patch(PatchId{3}, "R1", testing::scan_at(with_person, poses[3], 4'000'000), Laser{}, {});
  const MapCopy once = map_of(with_person, {poses[0]});
  EXPECT_EQ(at(render_island(once, all_of(once), 0.05), 4.4, 2.01), 0);
  EXPECT_EQ(at(render_island(map, all_of(map), 0.05), 4.4, 2.01), 254);
  EXPECT_EQ(at(render_island(map, all_of(map), 0.05), 6.03, 2.01), 0) << "the wall behind stays";
}

TEST(Grid, AThinPostThatEveryoneSeesStays) {
  std::vector<Wall> walls = rectangle(0.025, 0.025, 6.025, 4.025);
  for (const Wall& side : rectangle(2.95, 1.95, 3.05, 2.05)) walls.push_back(side);
  const MapCopy map = map_of(walls, {{1, 1, 0}, {5, 1, 0}, {5, 3, 0}, {1, 3, 0}, {3, 1, 0}, {1.2, 2, 0}});
  const OccupancyGrid grid = render_island(map, all_of(map), 0.05);
  int occupied = 0;
  for (const double x : {2.93, 2.97, 3.02, 3.07}) {
    for (const double y : {1.93, 1.97, 2.02, 2.07}) occupied += at(grid, x, y) == 0;
  }
  EXPECT_GE(occupied, 6);
}

TEST(Grid, OnlyTheIslandsOwnPatchesAreDrawn) {
  const MapCopy map = map_of(rectangle(0, 0, 4, 4), {{2, 2, 0}, {102, 2, 0}});
  const OccupancyGrid grid = render_island(map, {PatchId{0}}, 0.05);
  EXPECT_LT(grid.width, 120);
}

TEST(Grid, ALargeIslandIsCoarsenedToTheBound) {
  const MapCopy map = map_of(rectangle(0, 0, 20, 20), {{10, 10, 0}});
  const OccupancyGrid grid = render_island(map, all_of(map), 0.05, 10'000);
  EXPECT_LE(grid.pixels.size(), 10'000u);
  EXPECT_GT(grid.pixels.size(), 7'000u);
  EXPECT_GT(grid.resolution_m, 0.2);
  EXPECT_EQ(at(grid, 10, 10), 254);
}

TEST(Grid, PosesWithoutMeaningDoNoHarm) {
  MapCopy map = map_of(rectangle(0, 0, 4, 4), {{2, 2, 0}, {2, 2, 0}, {2, 2, 0}});
  map.poses[1].x = std::numeric_limits<double>::quiet_NaN();
  map.poses[2].y = 1e300;
  const OccupancyGrid grid = render_island(map, all_of(map), 0.05);
  EXPECT_LT(grid.width, 120);
  EXPECT_EQ(at(grid, 2, 2), 254);
}

TEST(Grid, AnIslandWithNothingSeenIsUnknown) {
  const MapCopy map = map_of({}, {{0, 0, 0}});
  const OccupancyGrid grid = render_island(map, all_of(map), 0.05);
  EXPECT_GT(grid.width, 0);
  EXPECT_EQ(std::count(grid.pixels.begin(), grid.pixels.end(), 205),
            static_cast<std::ptrdiff_t>(grid.pixels.size()));
}

}  // namespace
}  // namespace isthmus
