#include "server/paths/ground/island_surface.hpp"

#include <gtest/gtest.h>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::Seen;

constexpr int tile_cells = ground_tile_cells;
constexpr std::size_t all_cells = std::size_t{tile_cells} * tile_cells;

/// Two tiles beside one another, the second with a pillar at a column of its own.
IslandSurface::Tiles two_tiles(int pillar_x) {
  IslandSurface::Tiles tiles;
  for (int column = 0; column < 2; ++column) {
    const auto tile = testing::tile_of({column * tile_cells, 0}, [=](int x, int y) {
      return x == tile_cells + pillar_x && y == 60 ? Seen::occupied : Seen::open;
    });
    tiles[{0, column}] = std::make_shared<const GroundTile>(tile);
  }
  return tiles;
}

float wall_m(const IslandSurface& surface, std::size_t tile, int x, int y) {
  const TileSurface& of_tile = *surface.surfaces()[tile];
  return of_tile.wall_m[of_tile.tile->first[GroundTile::index(x, y)]];
}

TEST(IslandSurface, DistancesGoOnFromTileToTile) {
  IslandSurface surface;
  surface.update(two_tiles(5), {});
  EXPECT_NEAR(wall_m(surface, 0, tile_cells - 5, 60), (10 - 0.71) * ground_cell_m, 1e-3);
}

TEST(IslandSurface, WhatLiesNearAChangeIsMadeAgainAndNothingElse) {
  IslandSurface surface;
  surface.update(two_tiles(60), {});
  const auto before = surface.surfaces();
  EXPECT_FALSE(surface.update(two_tiles(60), {})) << "the same content is no change";
  EXPECT_TRUE(surface.update(two_tiles(70), {}));
  const auto far = surface.surfaces();
  EXPECT_EQ(far[0], before[0]) << "3 m from the pillar";
  EXPECT_NE(far[1], before[1]);
  surface.update(two_tiles(10), {});
  EXPECT_NE(surface.surfaces()[0], before[0]) << ".5 m from the pillar";
  EXPECT_LT(wall_m(surface, 0, tile_cells - 1, 60), 0.6F);
}

TEST(IslandSurface, WhereNearnessChangedItIsMadeAgain) {
  IslandSurface surface;
  surface.update(two_tiles(60), {});
  const auto before = surface.surfaces();
  EXPECT_TRUE(surface.update(two_tiles(60), {}, {{0, 0}}));
  EXPECT_NE(surface.surfaces()[0], before[0]);
}

TEST(IslandSurface, BesideATileThatIsGoneNothingIsSeen) {
  IslandSurface surface;
  IslandSurface::Tiles tiles = two_tiles(60);
  surface.update(tiles, {});
  EXPECT_FALSE(surface.surfaces()[0]->borders_on_unseen[GroundTile::index(tile_cells - 1, 60)]);
  tiles.erase({0, 1});
  surface.update(tiles, {});
  ASSERT_EQ(surface.surfaces().size(), 1U);
  EXPECT_TRUE(surface.surfaces()[0]->borders_on_unseen[GroundTile::index(tile_cells - 1, 60)]);
}

TEST(IslandSurface, AGapThatLiesOnTwoTilesIsFilledOnBoth) {
  IslandSurface surface;
  IslandSurface::Tiles tiles;
  for (int column = 0; column < 2; ++column) {
    const auto tile = testing::tile_of({column * tile_cells, 0}, [](int x, int y) {
      return x >= tile_cells - 3 && x < tile_cells + 3 && y >= 60 && y < 66 ? Seen::nothing : Seen::open;
    });
    tiles[{0, column}] = std::make_shared<const GroundTile>(tile);
  }
  surface.update(tiles, {});
  for (const auto& of_tile : surface.surfaces()) EXPECT_EQ(of_tile->tile->layers.size(), all_cells);
}

TEST(IslandSurface, AGapIsFilledAsSoonAsTheTileBesideShowsThatNothingWasHitAtItsRim) {
  const auto tiles_with = [](Seen at_rim) {
    IslandSurface::Tiles tiles;
    for (int column = 0; column < 2; ++column) {
      const auto tile = testing::tile_of({column * tile_cells, 0}, [=](int x, int y) {
        if (x == tile_cells && y == 62) return at_rim;
        return x >= tile_cells - 5 && x < tile_cells && y >= 60 && y < 65 ? Seen::nothing : Seen::open;
      });
      tiles[{0, column}] = std::make_shared<const GroundTile>(tile);
    }
    return tiles;
  };
  IslandSurface surface;
  IslandSurface::Tiles tiles = tiles_with(Seen::occupied);
  surface.update(tiles, {});
  EXPECT_EQ(surface.surfaces()[0]->tile->layers.size(), all_cells - 25);
  tiles[{0, 1}] = tiles_with(Seen::open).at({0, 1});
  surface.update(tiles, {});
  EXPECT_EQ(surface.surfaces()[0]->tile->layers.size(), all_cells);
}

}  // namespace
}  // namespace isthmus
