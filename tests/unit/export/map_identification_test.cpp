#include "tools/export/map_identification.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

/// Two islands of one patch each.
MapCopy two_islands(double second_x_m) {
  MapCopy map;
  for (int i = 0; i < 2; ++i) {
    const Scan scan{i, -1.5, 0.1, std::vector<float>(31, 4.0F)};
    map.patches.push_back(make_patch(PatchId{i}, "R1", scan, Laser{}, PatchOptions{}));
    map.poses.push_back({i * second_x_m, 0, 0});
    map.graph.add_patch(PatchId{i});
  }
  return map;
}

nlohmann::json identified(const MapCopy& map, const std::string& link) {
  const TemporaryDirectory directory;
  for (const char* file : {"island-0.pgm", "island-1.pgm"}) std::ofstream(directory / file) << "abc";
  write_map_identification(map, "hall", link, directory / "");
  std::ifstream file(directory / "vda5050-maps.json");
  return nlohmann::json::parse(file);
}

TEST(MapIdentification, NamesEachIslandsGrid) {
  const auto maps = identified(two_islands(1), "https://maps.example/3");
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[0].at("mapId"), "hall-0");
  EXPECT_EQ(maps[1].at("mapId"), "hall-1");
  EXPECT_EQ(maps[1].at("mapDownloadLink"), "https://maps.example/3/island-1.pgm");
  EXPECT_EQ(maps[0].at("mapVersion").get<std::string>().size(), 16U);
  // NIST's example of SHA-256 (FIPS 180-4).
  EXPECT_EQ(maps[0].at("mapHash"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(MapIdentification, AnotherMapIsAnotherVersionOfTheSameId) {
  const auto before = identified(two_islands(1), "x/")[1], after = identified(two_islands(2), "x/")[1];
  EXPECT_EQ(before.at("mapId"), after.at("mapId"));
  EXPECT_NE(before.at("mapVersion"), after.at("mapVersion"));
  EXPECT_EQ(after.at("mapDownloadLink"), "x/island-1.pgm");
}

TEST(MapIdentification, AGridThatIsNotThereIsAnError) {
  const TemporaryDirectory directory;
  EXPECT_THROW(write_map_identification(two_islands(1), "hall", "x", directory / ""), std::runtime_error);
}

}  // namespace
}  // namespace isthmus
