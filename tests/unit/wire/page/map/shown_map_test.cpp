#include "server/wire/page/map/shown_map.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <tuple>

#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

using testing::map_of_islands;

LiveView view_of(const MapCopy& map) { return {std::make_shared<const MapCopy>(map), {}, 0, false}; }

template <class T>
T read(const std::string& bytes, std::size_t& at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  at += sizeof value;
  return value;
}

TEST(ShownMap, AnIslandHasANewVersionWhenItsPatchesOrRelationsChange) {
  MapCopy map = map_of_islands({{{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}}});
  const ShownMap one = shown_map(view_of(map), nullptr, 7);
  EXPECT_EQ(one.version, (std::map<IslandId, std::int64_t>{{PatchId{0}, 7}, {PatchId{2}, 7}}));
  map.poses[2].y = 0.3;
  const ShownMap two = shown_map(view_of(map), &one, 8);
  EXPECT_EQ(two.version.at(PatchId{0}), 7);
  EXPECT_EQ(two.version.at(PatchId{2}), 8);
  map.graph.add(testing::odometry_between(0, 1));
  const ShownMap three = shown_map(view_of(map), &two, 9);
  EXPECT_EQ(three.version.at(PatchId{0}), 9);
  EXPECT_EQ(three.version.at(PatchId{2}), 8);
  map.graph.add(testing::odometry_between(1, 2));
  const ShownMap merged = shown_map(view_of(map), &three, 10);
  EXPECT_EQ(merged.version, (std::map<IslandId, std::int64_t>{{PatchId{0}, 10}}));
}

/// R1 by the server's clock; R2's is three years behind.
MapCopy map_of_two_clocks() {
  constexpr std::int64_t behind_us = 100'000'000'000'000;
  MapCopy map = map_of_islands({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}});
  for (const auto& [patch, robot, utime] :
       {std::tuple(0, "R1", 10'000'000), {1, "R2", 20'000'000}, {2, "R1", 30'000'000}}) {
    Patch made = *map.patches[static_cast<std::size_t>(patch)];
    made.robot = robot;
    made.utime = 5 * behind_us + utime - (made.robot == "R2" ? behind_us : 0);
    map.patches[static_cast<std::size_t>(patch)] = std::make_shared<const Patch>(std::move(made));
  }
  map.health = {{"R1", {}, {}}, {"R2", {}, {}}};
  map.health[0].figures.clock_ahead_s = 0;
  map.health[1].figures.clock_ahead_s = -1e-6 * behind_us;
  return map;
}

TEST(ShownMap, PatchesOfRobotsWhoseClocksDifferAreInTheOrderInWhichTheyCame) {
  const ShownMap shown = shown_map(view_of(map_of_two_clocks()), nullptr, 1);
  EXPECT_EQ(tenths_of_patch(shown, 0), 0);
  EXPECT_EQ(tenths_of_patch(shown, 1), 100);
  EXPECT_EQ(tenths_of_patch(shown, 2), 200);
}

TEST(ShownMap, StampsOfAnySizeHaveATime) {
  MapCopy map = map_of_two_clocks();
  for (const double ahead_s : {1e300, -1e300, 9e12, -9e12}) {
    map.health[1].figures.clock_ahead_s = ahead_s;
    const ShownMap shown = shown_map(view_of(map), nullptr, 1);
    for (const std::size_t patch : {0U, 1U, 2U}) EXPECT_GE(tenths_of_patch(shown, patch), 0);
  }
}

TEST(ShownMap, PatchesAndRelationsOfAnIslandAreArrays) {
  const MapCopy map = map_of_islands({{{9, 9, 0}}, {{1, 2, 0.5}, {3, 4, -0.5}}});
  const ShownMap shown = shown_map(view_of(map), nullptr, 1);
  const std::string bytes = patch_arrays(shown, PatchId{1});
  std::size_t at = 0;
  EXPECT_EQ(read<std::uint32_t>(bytes, at), 2U);
  EXPECT_EQ(read<std::uint32_t>(bytes, at), 1U);
  EXPECT_EQ(read<std::uint32_t>(bytes, at), 4U);
  EXPECT_EQ(bytes.substr(at, 4), "R1\n ");
  at += 4;
  for (const std::int32_t expected : {1, 2, 0, 0}) EXPECT_EQ(read<std::int32_t>(bytes, at), expected);
  for (const float expected : {1.0F, 3.0F, 2.0F, 4.0F, 0.5F, -0.5F})
    EXPECT_EQ(read<float>(bytes, at), expected);
  for (const std::int32_t expected : {0, 0}) EXPECT_EQ(read<std::int32_t>(bytes, at), expected) << "when";
  for (const std::int32_t expected : {0, 1, 1, -1}) EXPECT_EQ(read<std::int32_t>(bytes, at), expected);
  EXPECT_EQ(at, bytes.size());
  EXPECT_EQ(patch_arrays(shown, PatchId{2}), "");
}

}  // namespace
}  // namespace isthmus
