#include "server/engine/map/island_fits.hpp"

#include <gtest/gtest.h>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using testing::odometry_relation;

constexpr std::int64_t much_later = 100'000'000;

// Two islands of three patches, a metre apart by their relations, that the map has at its origin.
Map two_crumpled_islands() {
  Map map;
  for (int i = 0; i < 6; ++i) {
    auto patch = std::make_shared<Patch>();
    patch->id = PatchId{i};
    map.add(patch, {});
    if (i % 3 > 0) map.relate(odometry_relation(PatchId{i - 1}, PatchId{i}, {1, 0, 0}));
  }
  return map;
}

double x(const Map& map, int patch) { return map.manifold().pose(PatchId{patch}).x; }

TEST(IslandFits, FitsTheIslandThatWasAskedFor) {
  Map map = two_crumpled_islands();
  IslandFits island_fits;
  EXPECT_FALSE(island_fits.busy());
  island_fits.request(PatchId{1});
  EXPECT_TRUE(island_fits.busy());
  island_fits.advance(map, 0, {});
  EXPECT_EQ(x(map, 2), 0) << "beside the engine, applied at a later event";
  island_fits.advance(map, much_later, {});
  EXPECT_NEAR(x(map, 2), 2, 1e-6);
  EXPECT_EQ(x(map, 5), 0) << "the other island was not asked for";
  EXPECT_FALSE(island_fits.busy());
}

TEST(IslandFits, FitsAnIslandOnceHoweverManyOfItsPatchesNameIt) {
  Map map = two_crumpled_islands();
  IslandFits island_fits;
  for (const int patch : {0, 1, 2, 4}) island_fits.request(PatchId{patch});
  island_fits.advance(map, 0, {});
  island_fits.advance(map, much_later, {});
  EXPECT_NEAR(x(map, 2), 2, 1e-6);
  EXPECT_TRUE(island_fits.busy()) << "the second island is next";
  island_fits.advance(map, 2 * much_later, {});
  EXPECT_NEAR(x(map, 5), 2, 1e-6);
  EXPECT_FALSE(island_fits.busy());
}

// What was begun before islands merged says where patches were on a map that is no more.
TEST(IslandFits, BeginsAnewWhereTheMapHasChanged) {
  Map map = two_crumpled_islands();
  IslandFits island_fits;
  island_fits.request(PatchId{3});
  island_fits.advance(map, 0, {});
  map.relate(odometry_relation(PatchId{2}, PatchId{3}, {1, 0, 0}));
  island_fits.map_changed();
  EXPECT_TRUE(island_fits.busy());
  island_fits.advance(map, much_later, {});
  EXPECT_EQ(x(map, 5), 0);
  island_fits.advance(map, 2 * much_later, {});
  EXPECT_NEAR(x(map, 5), 5, 1e-6) << "the merged island";
  EXPECT_FALSE(island_fits.busy());
}

TEST(IslandFits, HasNothingToFitOfAPatchAlone) {
  Map map = two_crumpled_islands();
  auto alone = std::make_shared<Patch>();
  alone->id = PatchId{6};
  map.add(alone, {7, 0, 0});
  IslandFits island_fits;
  island_fits.request(PatchId{6});
  island_fits.advance(map, 0, {});
  EXPECT_FALSE(island_fits.busy());
  EXPECT_EQ(x(map, 6), 7);
}

}  // namespace
}  // namespace isthmus
