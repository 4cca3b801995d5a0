#include "server/wire/live/map_publisher.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "isthmus/grid_t.hpp"
#include "isthmus/map_t.hpp"
#include "isthmus/zones_t.hpp"
#include "tests/support/published.hpp"
#include "tests/support/waiting.hpp"

namespace isthmus {
namespace {

using std::chrono::milliseconds;

/// Two robots' patches, each an island, or both on one.
std::shared_ptr<const MapCopy> two_patches(bool merged) {
  auto map = std::make_shared<MapCopy>();
  for (int i = 0; i < 2; ++i) {
    const Scan scan{i, -1.5, 0.1, std::vector<float>(31, 4.0F)};
    map->patches.push_back(make_patch(PatchId{i}, "R" + std::to_string(i), scan, Laser{}, PatchOptions{}));
    map->poses.push_back({static_cast<double>(i), 0, 0});
    map->graph.add_patch(PatchId{i});
  }
  if (!merged) return map;
  Relation relation;
  relation.a = PatchId{0};
  relation.b = PatchId{1};
  relation.kind = RelationKind::odometry;
  relation.measurement = RelativePose{{1, 0, 0}, Eigen::Matrix3d::Identity()};
  map->graph.add(relation);
  return map;
}

MapPublisherOptions at_once() {
  MapPublisherOptions options;
  options.grid_interval = options.chunk_pause = milliseconds(0);
  return options;
}

/// Islands by the grids that were sent, in order; −1 − the island for one that is withdrawn.
std::vector<int> grids(Published& published) {
  std::vector<int> islands;
  for (const grid_t& grid : published.of<grid_t>("ISTHMUS_GRID"))
    islands.push_back(grid.npixels > 0 ? grid.island : -1 - grid.island);
  return islands;
}

TEST(MapPublisher, SendsGridsAgainWithAWholeMapAndAtNoOtherTime) {
  Published published;
  MapPublisher publisher(published.sink(), at_once());
  const auto map = two_patches(false);
  const auto offered_until = [&](std::size_t count) {
    return happens([&] {
      publisher.offer(map, 1);
      return grids(published).size() >= count;
    });
  };
  ASSERT_TRUE(offered_until(2));
  for (int i = 0; i < 20; ++i) publisher.offer(map, 1);
  EXPECT_EQ(grids(published), (std::vector<int>{0, 1}));
  publisher.request_whole();
  ASSERT_TRUE(offered_until(4));
  EXPECT_EQ(grids(published), (std::vector<int>{0, 1, 0, 1}));
}

TEST(MapPublisher, SendsTheGridOfEachIslandAsItIsWithAWholeMap) {
  Published published;
  MapPublisherOptions seldom = at_once();
  seldom.grid_interval = std::chrono::hours(1);
  MapPublisher publisher(published.sink(), seldom);
  publisher.offer(two_patches(false), 1);
  ASSERT_TRUE(happens([&] { return grids(published).size() >= 2; }));
  EXPECT_EQ(grids(published), (std::vector<int>{0, 1})) << "both with the first map";
  const int width = published.of<grid_t>("ISTHMUS_GRID")[0].width;
  for (int i = 0; i < 20; ++i) publisher.offer(two_patches(true), 2);
  ASSERT_TRUE(happens([&] { return grids(published).size() >= 3; }));
  EXPECT_EQ(grids(published), (std::vector<int>{0, 1, -2})) << "withdrawn at once; the next is not due";
  ASSERT_TRUE(happens([&] {
    publisher.request_whole();
    publisher.offer(two_patches(true), 3);
    return published.of<grid_t>("ISTHMUS_GRID").back().width > width;
  })) << "with what has come on the island since";
  EXPECT_GT(published.of<grid_t>("ISTHMUS_GRID").back().utime, 1) << "of whichever of the later maps";
}

TEST(MapPublisher, SendsZonesWhenTheyChangeAndWithAWholeMap) {
  Published published;
  MapPublisher publisher(published.sink(), at_once());
  const auto zones = [&] { return published.of<zones_t>("ISTHMUS_ZONES"); };
  const auto offered_until = [&](const MapCopy& map, std::size_t count) {
    return happens([&] {
      publisher.offer(std::make_shared<const MapCopy>(map), 7);
      return zones().size() >= count;
    });
  };
  MapCopy map = *two_patches(false);
  ASSERT_TRUE(offered_until(map, 1));
  EXPECT_EQ(zones()[0].nzones, 0) << "who comes first learns that there are none";
  AnnotationRecord zone;
  zone.kind = AnnotationKind::keep_out;
  zone.name = "Stairs";
  zone.island = PatchId{1};
  for (const Pose& corner : {Pose{0, 0, 0}, Pose{1, 0, 0}, Pose{0, 1, 0}})
    zone.points.push_back({PatchId{1}, corner});
  map.annotations = {zone};
  ASSERT_TRUE(offered_until(map, 2));
  ASSERT_EQ(zones()[1].nzones, 1);
  EXPECT_EQ(zones()[1].zones[0].x_m, (std::vector<double>{1, 2, 1})) << "in the island's frame";
  EXPECT_EQ(zones()[1].utime, 7);
  const std::size_t maps = published.of<map_t>("ISTHMUS_MAP").size();
  for (int i = 0; i < 20; ++i) publisher.offer(std::make_shared<const MapCopy>(map), 7);
  EXPECT_EQ(zones().size(), 2U) << "nothing changed";
  publisher.request_whole();
  ASSERT_TRUE(offered_until(map, 3));
  EXPECT_GT(published.of<map_t>("ISTHMUS_MAP").size(), maps);
}

TEST(MapPublisher, WithdrawsTheGridOfAnIslandThatMerged) {
  Published published;
  MapPublisher publisher(published.sink(), at_once());
  EXPECT_TRUE(happens([&] {
    publisher.offer(two_patches(false), 1);
    return grids(published).size() >= 2;
  }));
  EXPECT_TRUE(happens([&] {
    publisher.offer(two_patches(true), 2);
    return grids(published).size() >= 4;
  }));
  EXPECT_EQ(grids(published), (std::vector<int>{0, 1, -2, 0}));
  const grid_t withdrawn = published.of<grid_t>("ISTHMUS_GRID")[2];
  EXPECT_EQ(withdrawn.island, 1);
  EXPECT_EQ(withdrawn.width, 0);
  EXPECT_EQ(withdrawn.height, 0);
}

}  // namespace
}  // namespace isthmus
