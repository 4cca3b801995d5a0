#include "server/output/pictures/map_pictures.hpp"

#include <gtest/gtest.h>

#include "server/output/tables/trajectories.hpp"
#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

using testing::add_tag;
using testing::room;

/// The room with a second robot that has an island of its own.
MapCopy two_islands() {
  MapCopy map = room();
  map.graph.remove(map.graph.between(PatchId{1}, PatchId{2}).front());
  map.sessions.push_back({"R9", 1, 4'000'000, 9'000'000, PatchId{2}});
  return map;
}

TEST(IslandContent, RobotsKeepTheColoursThatTheyCameWith) {
  MapCopy map = room();
  const Session first = map.sessions[0];
  for (const char* robot : {"R3", "R2"})
    map.sessions.push_back({robot, 1, first.from_utime, first.to_utime, first.first_patch});
  EXPECT_EQ(robots_as_they_came(map), (std::vector<std::string>{"R1", "R3", "R2"}));
  const IslandContent content = island_contents(map, rank_islands(map)).at(0);
  EXPECT_EQ(content.robots, (std::vector<std::size_t>{0, 1, 2}));
}

std::vector<std::string> texts(const Legend& legend) {
  std::vector<std::string> all;
  for (const LegendEntry& entry : legend) all.push_back(entry.text);
  return all;
}

TEST(IslandContent, TellsRobotsTagsAndTimeOfEachIsland) {
  MapCopy map = two_islands();
  add_tag(map, 17, PatchId{2}, {3.5, 2});
  const RankedIslands islands = rank_islands(map);
  const std::vector<IslandContent> contents = island_contents(map, islands);
  ASSERT_EQ(contents.size(), 2U);
  EXPECT_EQ(contents[0].robots, (std::vector<std::size_t>{0}));
  EXPECT_EQ(contents[1].robots, (std::vector<std::size_t>{0, 1}));
  EXPECT_TRUE(contents[0].tags.empty());
  ASSERT_EQ(contents[1].tags.size(), 1U);
  EXPECT_EQ(contents[1].tags[0]->barcode, 17);
  EXPECT_EQ(sheet_text(contents[0]).title, "Island 0 of 2");
  EXPECT_EQ(sheet_text(contents[1]).subtitle, "2 robots, 1 patch, 1 tag; from 4.0 s to 9.0 s");
}

TEST(IslandContent, AClosureIsShownOnceWithItsKind) {
  MapCopy map = room();
  for (const auto& [closure, kind] : {std::pair(4, ClosureKind::merge), {2, ClosureKind::loop}}) {
    ClosureRecord record;
    record.id = ClosureId{closure};
    record.kind = kind;
    map.closures.push_back(record);
    for (int i = 0; i < 2; ++i) {
      Relation relation = testing::relative_pose(PatchId{0}, PatchId{2}, ominus(map.poses[2], map.poses[0]),
                                                 Eigen::Matrix3d::Identity());
      relation.origin = {i == 0 ? OriginKind::hypothesis : OriginKind::propagation, ClosureId{closure}, -1};
      map.graph.add(relation);
    }
  }
  const RankedIslands islands = rank_islands(map);
  const IslandContent content = island_contents(map, islands).at(0);
  ASSERT_EQ(content.closures.size(), 2U);
  EXPECT_EQ(content.closures[0].id.value, 2);
  EXPECT_FALSE(content.closures[0].is_merge);
  EXPECT_TRUE(content.closures[1].is_merge);
  EXPECT_EQ(texts(island_legend(content, {"R1"})),
            (std::vector<std::string>{"R1", "start and heading", "end and heading", "patch",
                                      "closed loop with its id", "merge with its id"}));
}

TEST(IslandLegend, OfManyLoopsNoneHasItsIdAndMergesStillDo) {
  IslandContent content;
  for (int i = 0; i < 85; ++i)
    content.closures.push_back({ClosureId{i}, i % 17 == 0, PatchId{0}, PatchId{1}});
  EXPECT_EQ(content.loops(), 80U);
  EXPECT_EQ(texts(island_legend(content, {})),
            (std::vector<std::string>{"patch", "closed loop", "merge with its id"}));
}

/// The tag stands outside the room's grid, which ends at its walls.
TEST(MapPictures, ATagBesideTheGridIsOnThePicture) {
  const testing::TemporaryDirectory directory;
  const auto width_of = [&](const MapCopy& map) {
    const RankedIslands islands = rank_islands(map);
    MapPictures pictures(map, islands, directory.path());
    pictures.add(0, render_island(map, islands.patches[0]));
    pictures.finish();
    const std::string png = testing::content(directory.file("island-0-trajectory.png"));
    return static_cast<unsigned char>(png.at(18)) * 256 + static_cast<unsigned char>(png.at(19));
  };
  MapCopy map = room();
  const int without = width_of(map);
  add_tag(map, 17, PatchId{2}, {9, 2});
  EXPECT_GT(width_of(map), without + 200);
}

TEST(IslandLegend, OfManyRobotsItNamesTheFirst) {
  IslandContent content;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < 256; ++i) {
    content.robots.push_back(i);
    names.push_back("R" + std::to_string(i));
  }
  const std::vector<std::string> shown = texts(island_legend(content, names));
  EXPECT_EQ(shown[39], "R39");
  EXPECT_EQ(shown[40], "and 216 more");
}

TEST(TimeText, IsADateWhereStampsAreOfThisAge) {
  EXPECT_EQ(time_text(1'700'000'000'000'000, 1'700'000'012'500'000), "from 2023-11-14 22:13:20 UTC, 12.5 s");
  EXPECT_EQ(time_text(976'052'857'300'000, 976'052'858'300'000), "from 2000-12-05 21:47:37 UTC, 1.0 s");
  EXPECT_EQ(time_text(1'000'000, 61'500'000), "from 1.0 s to 61.5 s");
  EXPECT_EQ(time_text(1, 0), "");
}

OverviewParts parts_of(const std::vector<Eigen::Vector2d>& sizes_m) {
  OverviewParts parts;
  parts.sizes_m = sizes_m;
  parts.label_widths.assign(sizes_m.size(), 130);
  parts.title_width = 300;
  parts.legend_entries = 6;
  parts.legend_width = 150;
  return parts;
}

void expect_in_order(const OverviewParts& parts) {
  const OverviewPlan plan = plan_overview(parts);
  std::vector<PixelBox> boxes = plan.maps;
  boxes.insert(boxes.end(), plan.labels.begin(), plan.labels.end());
  boxes.insert(boxes.end(), plan.legend.begin(), plan.legend.end());
  boxes.push_back(plan.bar);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_GE(boxes[i].left, 0);
    EXPECT_LE(boxes[i].right, plan.width);
    EXPECT_LE(boxes[i].bottom, plan.height);
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(boxes[i].overlaps(boxes[j])) << i << ", " << j;
  }
  for (std::size_t k = 0; k < plan.maps.size(); ++k)
    EXPECT_NEAR(plan.maps[k].width(), std::max(6.0, parts.sizes_m[k].x() * plan.pixels_per_m), 1);
}

TEST(OverviewPlan, IslandsStandSideBySideInOneScale) {
  expect_in_order(parts_of({{40, 30}, {25, 10}, {12, 30}, {2, 2}}));
  expect_in_order(parts_of({{0, 0}}));
  expect_in_order(parts_of({{2000, 3}, {3, 500}}));
  expect_in_order(parts_of(std::vector<Eigen::Vector2d>(60, {30, 30})));
  expect_in_order(parts_of({{500, 500}, {1, 1}, {1, 1}}));
}

TEST(OverviewPlan, OfManyIslandsItShowsTheLargest) {
  EXPECT_EQ(plan_overview(parts_of(std::vector<Eigen::Vector2d>(1000, {30, 30}))).maps.size(), 60U);
}

TEST(OverviewPlan, FitsAScreen) {
  for (const std::size_t islands : {1U, 2U, 7U, 60U}) {
    const OverviewPlan plan = plan_overview(parts_of(std::vector<Eigen::Vector2d>(islands, {60, 45})));
    EXPECT_LT(plan.width, 2200);
    EXPECT_LT(plan.height, 1500);
    EXPECT_GT(plan.width * plan.height, 700 * 500);
  }
}

}  // namespace
}  // namespace isthmus
