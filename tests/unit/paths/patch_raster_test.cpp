#include "server/paths/ground/patch_raster.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

bool is_free(const PatchRaster& raster, const Cell& cell) {
  const auto runs = raster.runs(cell.y);
  return std::any_of(runs.begin(), runs.end(),
                     [&](const PatchRaster::Run& run) { return cell.x >= run.begin && cell.x < run.end; });
}

bool has(std::span<const std::int32_t> columns, const Cell& cell) {
  return std::find(columns.begin(), columns.end(), cell.x) != columns.end();
}

/// A room of 4 m by 2 m around the patch.
testing::Walls room() {
  testing::Walls walls;
  testing::add_box(walls, -2, -1, 2, 1);
  return walls;
}

TEST(PatchRaster, FreeSpaceEndsAtTheWallsThatWereHit) {
  const PatchPtr patch = testing::round_patch(room(), PatchId{0}, {});
  const PatchRaster raster({*patch, Pose{}});
  EXPECT_TRUE(is_free(raster, cell_of({1.8, 0.8})));
  EXPECT_FALSE(is_free(raster, cell_of({2.1, 0.8})));
  EXPECT_TRUE(has(raster.hits(cell_of({0, 1.01}).y), cell_of({0, 1.01})));
  EXPECT_FALSE(has(raster.hits(cell_of({0, 0.5}).y), cell_of({0, 0.5})));
}

TEST(PatchRaster, ItLiesAtThePatchesPose) {
  const PatchPtr patch = testing::round_patch(room(), PatchId{0}, {});
  const PatchRaster raster({*patch, Pose{10, 20, 1.5707963267948966}});
  EXPECT_TRUE(is_free(raster, cell_of({10.8, 21.8})));
  EXPECT_FALSE(is_free(raster, cell_of({11.8, 20.8})));
}

TEST(PatchRaster, RowsOutsideAreEmpty) {
  const PatchPtr patch = testing::round_patch(room(), PatchId{0}, {});
  const PatchRaster raster({*patch, Pose{}});
  EXPECT_TRUE(raster.runs(raster.high().y).empty());
  EXPECT_TRUE(raster.runs(raster.low().y - 1).empty());
  EXPECT_TRUE(raster.hits(raster.high().y).empty());
  EXPECT_TRUE(raster.presumed(raster.low().y - 1).empty());
}

TEST(PatchRaster, RobotsStoodAtTheOriginAndWhereTheyDrove) {
  const PatchPtr patch = testing::round_patch(room(), PatchId{0}, {});
  const std::vector<Eigen::Vector2d> driven{{5, 0}};  // farther than it sees
  const PatchRaster raster({*patch, Pose{}}, driven);
  const Cell origin = cell_of({0, 0.2}), there = cell_of({5.2, 0}), beside = cell_of({5.4, 0});
  EXPECT_TRUE(has(raster.presumed(origin.y), origin));
  EXPECT_TRUE(has(raster.presumed(there.y), there));
  EXPECT_FALSE(has(raster.presumed(beside.y), beside));
}

}  // namespace
}  // namespace isthmus
