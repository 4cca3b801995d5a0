#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "relations/confidence.hpp"
#include "server/output/format/number.hpp"
#include "server/output/grid/grid.hpp"
#include "server/output/output.hpp"
#include "server/output/report.hpp"
#include "server/output/tables/graph_g2o.hpp"
#include "server/output/tables/islands.hpp"
#include "server/output/tables/tables.hpp"
#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

using testing::add_tag;
using testing::lines;
using testing::map_of;
using testing::rectangle;
using testing::TemporaryDirectory;

/// Patches 0 | 1 - 2 of R1; of the tags, patches 3 to 7, three seen from patch 0, one from patch 2, one
/// alone.
///
///     [0]--7,8,9      [1]--[2]--10      11
MapCopy tagged() {
  MapCopy map = map_of(rectangle(0, 0, 4, 4), {{1, 1, 0}, {2, 2, 0}, {3, 2, 1.5}});
  map.graph.remove(map.graph.between(PatchId{0}, PatchId{1}).front());
  for (const std::int32_t barcode : {7, 8, 9}) add_tag(map, barcode, PatchId{0}, {0.5 * barcode, 3});
  add_tag(map, 10, PatchId{2}, {1.5, -2});
  add_tag(map, 11, PatchId{}, {0, 0});
  return map;
}

TEST(Tags, CountForNothingWhereIslandsAreRanked) {
  const RankedIslands islands = rank_islands(tagged());
  ASSERT_EQ(islands.patches.size(), 2u) << "one of tags only has no rank";
  EXPECT_EQ(islands.patches[0], (std::vector<PatchId>{PatchId{1}, PatchId{2}}));
  EXPECT_EQ(islands.patches[1], (std::vector<PatchId>{PatchId{0}}));
  EXPECT_EQ(islands.tags[0], (std::vector<PatchId>{PatchId{6}}));
  EXPECT_EQ(islands.rank(PatchId{4}), 1);
  EXPECT_EQ(islands.rank(PatchId{7}), -1);
}

TEST(Tags, AreNoRowsOfPatchesButHaveTheirOwn) {
  MapCopy map = tagged();
  map.tags.push_back({12, {}, Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero(), false, {}});
  const TemporaryDirectory directory;
  write_patches(map, rank_islands(map), directory.file("patches.csv"));
  EXPECT_EQ(lines(directory.file("patches.csv")).size(), 4u);

  write_tags(map, rank_islands(map), directory.file("tags.csv"));
  const auto rows = lines(directory.file("tags.csv"));
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_EQ(rows[0], "barcode,island,x_m,y_m,cov_x_x,cov_x_y,cov_y_y,patch");
  EXPECT_TRUE(rows[4].starts_with("10,0,1.5,-2,")) << rows[4];
  EXPECT_TRUE(rows[4].ends_with(",6")) << rows[4];
  EXPECT_EQ(rows[5], "11,-1,nan,nan,nan,nan,nan,7");
  EXPECT_EQ(rows[6], "12,-1,nan,nan,nan,nan,nan,-1");
}

TEST(Tags, HaveTheExactCovarianceRelativeToTheFirstPatch) {
  const MapCopy map = tagged();
  const TemporaryDirectory directory;
  write_tags(map, rank_islands(map), directory.file("tags.csv"));
  const std::string row = lines(directory.file("tags.csv"))[1];  // one sighting, from the first patch itself
  std::vector<double> cells;
  std::istringstream stream(row);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(std::stod(cell));
  ASSERT_EQ(cells.size(), 8u) << row;
  EXPECT_NEAR(cells[4], 0.01, 1e-9);
  EXPECT_NEAR(cells[5], 0, 1e-9);
  EXPECT_NEAR(cells[6], 0.04, 1e-9);

  const std::vector<PatchId> farther = {PatchId{6}};
  const Eigen::Matrix3d c = exact_relative_covariances(map.graph, map.poses, PatchId{1}, farther).front();
  EXPECT_GT(c(0, 0), 0.04) << "the way to patch 2 is uncertain too";
  EXPECT_NE(lines(directory.file("tags.csv"))[4].find(number(c(0, 0)) + ","), std::string::npos);
}

TEST(Tags, AnIslandIsLedByAPatchEvenWhereATagIsOlder) {
  MapCopy map = map_of({}, {});
  const PatchId tag = add_tag(map, 7, PatchId{}, {1, 0});
  map.patches.push_back(make_patch(PatchId{1}, "R1", testing::scan_at({}, {}, 1), Laser{}, {}));
  map.poses.push_back({});
  map.graph.add_patch(PatchId{1});
  map.graph.add(testing::relative_pose(tag, PatchId{1}, {-1, 0, 0}, Eigen::Matrix3d::Identity()));
  const TemporaryDirectory directory;
  write_patches(map, rank_islands(map), directory.file("patches.csv"));
  EXPECT_TRUE(lines(directory.file("patches.csv"))[1].starts_with("1,R1,1,0,0,0,0,0,0,0,0,0,0,"));
}

TEST(Tags, StayInTheGraphWithAFixForThoseAlone) {
  const MapCopy map = tagged();
  const TemporaryDirectory directory;
  write_g2o(map, rank_islands(map), directory.file("graph.g2o"));
  write_relations(map, directory.file("relations.csv"));
  EXPECT_EQ(lines(directory.file("relations.csv")).size(), 1u + 5u);
  std::vector<std::string> fixed;
  int vertices = 0;
  for (const std::string& row : lines(directory.file("graph.g2o"))) {
    if (row.starts_with("FIX ")) fixed.push_back(row);
    vertices += row.starts_with("VERTEX_SE2 ") ? 1 : 0;
  }
  EXPECT_EQ(vertices, 8);
  EXPECT_EQ(fixed, (std::vector<std::string>{"FIX 1", "FIX 0", "FIX 7"}));
}

TEST(Tags, TheReportCountsThemBesideThePatches) {
  const MapCopy map = tagged();
  const auto report = nlohmann::json::parse(report_json(map, rank_islands(map), {}));
  EXPECT_EQ(report["patches"], 3);
  EXPECT_EQ(report["tags"], 5);
  EXPECT_EQ(report["islands"], 2);
  EXPECT_EQ(report["island_list"][0]["patches"], 2);
  EXPECT_EQ(report["island_list"][0]["tags"], 1);
  EXPECT_EQ(report["island_list"][0]["robots"], nlohmann::json({"R1"}));
}

TEST(Tags, LeaveNoTraceInGrids) {
  MapCopy map = map_of(rectangle(0, 0, 4, 4), {{1, 1, 0}});
  const OccupancyGrid without = render_island(map, {PatchId{0}});
  const PatchId tag = add_tag(map, 7, PatchId{0}, {30, 30});
  const OccupancyGrid with = render_island(map, {PatchId{0}, tag});
  EXPECT_EQ(with.width, without.width);
  EXPECT_EQ(with.pixels, without.pixels);
}

}  // namespace
}  // namespace isthmus
