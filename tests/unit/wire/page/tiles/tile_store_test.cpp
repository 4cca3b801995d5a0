#include "server/wire/page/tiles/tile_store.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>

#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

using testing::map_of_islands;

constexpr IslandId first_island{0};
constexpr std::int64_t before_all = 1000;

using Pixels = std::vector<std::uint8_t>;

/// Of a PNG of 256 x 256 grey values.
Pixels decoded(const std::string& png) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0) << image.message;
  image.format = PNG_FORMAT_GRAY;
  Pixels pixels(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0) << image.message;
  EXPECT_EQ(pixels.size(), std::size_t{tile_cells} * tile_cells);
  return pixels;
}

std::map<TileKey, std::int64_t> versions(const TileStore& store, IslandId island, std::int64_t since = 0) {
  std::map<TileKey, std::int64_t> all;
  for (const auto& [key, version] : store.changed_since(island, since)) all.emplace(key, version);
  return all;
}

/// The value of a tile of zoom 0 at a cell of the island, counted from its origin to the right and up.
std::uint8_t at(const Pixels& pixels, int column, int row) {
  const int x = column & (tile_cells - 1);
  const int y = (-row - 1) & (tile_cells - 1);
  const int cell = y * tile_cells + x;
  return pixels[static_cast<std::size_t>(cell)];
}

// Four tiles meet at the origin, in the middle of the room.
TEST(TileStore, TilesShowTheCellsOfTheWholeGrid) {
  const MapCopy map = map_of_islands({{{-2.1, -1.2, 0.3}, {0.4, 0.2, 1.9}, {1.1, -0.7, -2.5}}});
  const OccupancyGrid whole = render_island(map, map.graph.patches_of(first_island));
  TileStore store(before_all);
  store.update(map);
  const int left = static_cast<int>(std::lround(whole.origin_x_m / finest_cell_m));
  const int bottom = static_cast<int>(std::lround(whole.origin_y_m / finest_cell_m));
  std::map<TileKey, Pixels> tiles;
  int compared = 0;
  for (int row = 0; row < whole.height; ++row) {
    for (int column = 0; column < whole.width; ++column) {
      const TileKey key{0, (left + column) >> 8, (-(bottom + row) - 1) >> 8};
      if (!tiles.contains(key)) {
        const auto image = store.image(first_island, key);
        ASSERT_TRUE(image) << key.x << " " << key.y;
        tiles[key] = decoded(*image->png);
      }
      const int cell = (whole.height - 1 - row) * whole.width + column;
      const auto i = static_cast<std::size_t>(cell);
      ASSERT_EQ(at(tiles[key], left + column, bottom + row), whole.pixels[i]) << column << " " << row;
      ++compared;
    }
  }
  EXPECT_EQ(tiles.size(), 4U);
  EXPECT_GT(compared, 160 * 120);
}

TEST(TileStore, ATileOfAZoomBelowShowsItsQuartersWithTheirWalls) {
  TileStore store(before_all);
  store.update(map_of_islands({{{0.4, 0.2, -0.8}}}));
  const Pixels fine = decoded(*store.image(first_island, {0, 0, 0})->png);
  const Pixels coarse = decoded(*store.image(first_island, {-1, 0, 0})->png);
  int walls = 0;
  for (std::size_t y = 0; y < tile_cells / 2; ++y) {
    for (std::size_t x = 0; x < tile_cells / 2; ++x) {
      const std::size_t i = 2 * y * tile_cells + 2 * x;
      const std::array<std::uint8_t, 4> four = {fine[i], fine[i + 1], fine[i + tile_cells],
                                                fine[i + tile_cells + 1]};
      const bool is_wall = std::ranges::count(four, OccupancyGrid::occupied) > 0;
      const std::uint8_t shown = is_wall ? OccupancyGrid::occupied : std::ranges::max(four);
      ASSERT_EQ(coarse[y * tile_cells + x], shown) << x << " " << y;
      walls += is_wall ? 1 : 0;
    }
  }
  EXPECT_GT(walls, 20);
  EXPECT_TRUE(store.image(first_island, {coarsest_zoom, 0, 0}));
  EXPECT_FALSE(store.image(first_island, {coarsest_zoom - 1, 0, 0}));
  EXPECT_FALSE(store.image(first_island, {1, 0, 0}));
}

// The second patch lies 40 m to the right of the first_island.
TEST(TileStore, OnlyTilesOfPatchesThatChangedGetANewVersion) {
  MapCopy map = map_of_islands({{{0.3, 0.2, 0}, {0.1, 0.4, 0}}});
  map.poses[1].x = 40;
  TileStore store(before_all);
  store.update(map);
  const auto before = versions(store, first_island);
  const std::int64_t newest = store.islands().at(first_island).version;
  EXPECT_GT(newest, before_all);

  store.update(map);
  EXPECT_EQ(versions(store, first_island), before) << "nothing changed";
  map.poses[1].x += 0.01;
  store.update(map);
  EXPECT_EQ(versions(store, first_island), before) << "less than half a cell";

  map.poses[1].x += 0.03;
  store.update(map);
  const auto changed = versions(store, first_island, newest);
  ASSERT_FALSE(changed.empty());
  for (const auto& [key, version] : changed)
    EXPECT_TRUE(key.x >= 2 || key.zoom < 0) << key.zoom << " " << key.x << " " << key.y;
  EXPECT_TRUE(changed.contains({coarsest_zoom, 0, 0}));
  EXPECT_LT(changed.size(), before.size());
}

TEST(TileStore, ATileIsDrawnOncePerVersion) {
  MapCopy map = map_of_islands({{{0.3, 0.2, 0}}});
  TileStore store(before_all);
  store.update(map);
  const auto image = store.image(first_island, {0, 0, 0});
  EXPECT_EQ(store.image(first_island, {0, 0, 0})->png, image->png);
  EXPECT_EQ(image->version, versions(store, first_island).at({0, 0, 0}));
  map.poses[0].y += 0.5;
  store.update(map);
  const auto later = store.image(first_island, {0, 0, 0});
  EXPECT_GT(later->version, image->version);
  EXPECT_NE(*later->png, *image->png);
}

TEST(TileStore, AnIslandThatMergedIsGoneAndItsPatchesAreOnTheOther) {
  MapCopy map = map_of_islands({{{0.3, 0.2, 0}}, {{0.3, 0.2, 0}}});
  TileStore store(before_all);
  store.update(map);
  EXPECT_EQ(store.islands().size(), 2U);
  map.graph.add(testing::odometry_between(0, 1));
  map.poses[1].x = 40;
  store.update(map);
  const auto islands = store.islands();
  ASSERT_EQ(islands.size(), 1U);
  EXPECT_GT(islands.at(first_island).box.high.x(), 40);
  EXPECT_TRUE(store.image(first_island, {0, 3, 0}));
  EXPECT_FALSE(store.image(PatchId{1}, {0, 0, 0}));
}

TEST(TileStore, PatchesThatAreLeftOutLeaveNoTrace) {
  MapCopy map = map_of_islands({{{0.3, 0.2, 0}, {0.2, 0.1, 0}}});
  map.poses[1].x = 40;
  TileStore store(before_all);
  store.update(map);
  map.left_out = {PatchId{1}};
  store.update(map);
  EXPECT_LT(store.islands().at(first_island).box.high.x(), 40);
  const Pixels emptied = decoded(*store.image(first_island, {0, 3, 0})->png);
  EXPECT_EQ(std::ranges::count(emptied, OccupancyGrid::unknown), std::ptrdiff_t{tile_cells} * tile_cells);
}

}  // namespace
}  // namespace isthmus
