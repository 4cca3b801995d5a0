#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>

#include "server/output/format/atomic_file.hpp"
#include "server/output/output.hpp"
#include "server/output/pictures/map_pictures.hpp"
#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;
using testing::content;
using testing::lines;
using testing::map_of;
using testing::rectangle;
using testing::room;
using testing::TemporaryDirectory;

std::set<std::string> names_in(const std::string& directory) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.is_regular_file()) names.insert(fs::relative(entry.path(), directory).string());
  }
  return names;
}

struct Pgm {
  int width = 0;
  int height = 0;
  std::string pixels;
};

Pgm read_pgm(const std::string& file) {
  const std::string bytes = content(file);
  std::istringstream header(bytes);
  std::string magic;
  Pgm pgm;
  int most = 0;
  header >> magic >> pgm.width >> pgm.height >> most;
  EXPECT_EQ(magic, "P5");
  EXPECT_EQ(most, 255);
  pgm.pixels = bytes.substr(static_cast<std::size_t>(header.tellg()) + 1);
  return pgm;
}

TEST(WriteOutputs, PlacesAndZonesAreGeoJson) {
  MapCopy map = room();
  AnnotationRecord zone;
  zone.kind = AnnotationKind::speed;
  zone.name = "Ramp";
  zone.max_speed_m_s = 0.5;
  zone.island = PatchId{0};
  zone.points = {{PatchId{0}, {0, 0, 0}}, {PatchId{0}, {0, 1, 0}}, {PatchId{1}, {0, 0, 0}}};
  AnnotationRecord lost;
  lost.name = "Dock";
  lost.lost = true;
  lost.points = {{PatchId{2}, {1, 2, 3}}};
  map.annotations = {lost, zone};
  const TemporaryDirectory directory;
  write_outputs(map, {}, directory.file("out"), {0.05, {10, 0, 0}});
  const auto json = nlohmann::json::parse(content(directory.file("out/places.geojson")));
  const auto& features = json.at("features");
  ASSERT_EQ(features.size(), 2U);
  EXPECT_TRUE(features[0].at("geometry").is_null());
  EXPECT_EQ(features[0].at("properties").at("lost"), true);
  EXPECT_EQ(features[0].at("properties").at("island"), -1);
  EXPECT_EQ(features[1].at("properties").at("max_speed_m_s"), 0.5);
  EXPECT_EQ(features[1].at("properties").at("island"), 0);
  const auto& ring = features[1].at("geometry").at("coordinates").at(0);
  ASSERT_EQ(ring.size(), 4U) << "it ends where it begins";
  EXPECT_EQ(ring[0], ring[3]);
  EXPECT_EQ(ring, nlohmann::json::parse("[[12, 1], [11, 2], [11, 1], [12, 1]]"))
      << "moved with --align, turned round";
  write_outputs(room(), {}, directory.file("out"));
  EXPECT_FALSE(fs::exists(directory.file("out/places.geojson"))) << "of an earlier result";
}

TEST(WriteOutputs, EveryFileIsThereAndNoOther) {
  const TemporaryDirectory directory;
  write_outputs(room(), {}, directory.file("new/out"));
  EXPECT_EQ(names_in(directory.file("new/out")),
            (std::set<std::string>{"finds.csv", "graph.g2o", "island-0-trajectory.png", "island-0.pgm",
                                   "island-0.png", "island-0.yaml", "overview.png", "patches.csv",
                                   "relations.csv", "report.json", "robots.csv", "sightings.csv", "tags.csv",
                                   "trajectories/R1.tum"}));
}

TEST(WriteOutputs, AnEmptyMapIsWrittenToo) {
  const TemporaryDirectory directory;
  write_outputs(MapCopy{}, {}, directory.path());
  EXPECT_EQ(names_in(directory.path()),
            (std::set<std::string>{"finds.csv", "graph.g2o", "overview.png", "patches.csv", "relations.csv",
                                   "report.json", "robots.csv", "sightings.csv", "tags.csv"}));
}

TEST(WriteOutputs, TheGridReadsBackAsMapServerReadsIt) {
  const TemporaryDirectory directory;
  write_outputs(room(), {}, directory.path(), {.resolution_m = 0.05, .align = {}});
  EXPECT_EQ(lines(directory.file("island-0.yaml")),
            (std::vector<std::string>{"image: island-0.pgm", "mode: trinary", "resolution: 0.05",
                                      "origin: [-0.200000, -0.200000, 0.0]", "negate: 0",
                                      "occupied_thresh: 0.65", "free_thresh: 0.196"}));
  const Pgm pgm = read_pgm(directory.file("island-0.pgm"));
  ASSERT_EQ(pgm.pixels.size(), static_cast<std::size_t>(pgm.width * pgm.height));
  // map_server: occupancy (255 - p) / 255; above 0.65 occupied, below free_thresh free, else unknown.
  const auto state = [&](double x, double y) {
    const int column = static_cast<int>(std::floor((x + 0.2) / 0.05));
    const int row = pgm.height - 1 - static_cast<int>(std::floor((y + 0.2) / 0.05));
    const auto pixel =
        static_cast<unsigned char>(pgm.pixels[static_cast<std::size_t>(row * pgm.width + column)]);
    const double occupancy = (255.0 - pixel) / 255.0;
    return occupancy > 0.65 ? "occupied" : occupancy < 0.196 ? "free" : "unknown";
  };
  EXPECT_STREQ(state(2.01, 1.51), "free");
  EXPECT_STREQ(state(2.01, 0.025), "occupied");
  EXPECT_STREQ(state(2.01, 3.025), "occupied");
  EXPECT_STREQ(state(4.025, 2.01), "occupied");
  EXPECT_STREQ(state(-0.1, 1.51), "unknown");
  EXPECT_EQ(std::set<char>(pgm.pixels.begin(), pgm.pixels.end()).size(), 3u);
}

TEST(WriteOutputs, ThePictureForMapServerIsOfTheGridsSize) {
  const TemporaryDirectory directory;
  write_outputs(room(), {}, directory.path());
  const Pgm pgm = read_pgm(directory.file("island-0.pgm"));
  const std::string png = content(directory.file("island-0.png"));
  ASSERT_EQ(png.substr(1, 3), "PNG");
  const auto big_endian = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value * 256 + static_cast<unsigned char>(png[i]);
    return value;
  };
  EXPECT_EQ(big_endian(16), pgm.width);
  EXPECT_EQ(big_endian(20), pgm.height);
}

// However many islands there are, only some are held at once.
TEST(WriteOutputs, PicturesDrawnSomeAtATimeAreAsThoseDrawnTogether) {
  const TemporaryDirectory directory;
  MapCopy map = room();
  map.graph.remove(map.graph.between(PatchId{0}, PatchId{1}).front());
  const RankedIslands islands = rank_islands(map);
  ASSERT_EQ(islands.patches.size(), 2U);
  const auto draw = [&](const std::string& where, std::size_t max_waiting_pixels) {
    make_directory(directory.file(where));
    MapPictures pictures(map, islands, directory.file(where), max_waiting_pixels);
    for (const std::size_t k : {0U, 1U}) pictures.add(k, render_island(map, islands.patches[k], 0.05));
    pictures.finish();
  };
  draw("together", 24'000'000);
  draw("apart", 0);
  for (const std::string name : {"island-0-trajectory.png", "island-1-trajectory.png", "overview.png"})
    EXPECT_EQ(content(directory.file("together/" + name)), content(directory.file("apart/" + name))) << name;
  EXPECT_NE(content(directory.file("apart/island-0-trajectory.png")),
            content(directory.file("apart/island-1-trajectory.png")));
}

TEST(WriteOutputs, AlignMovesTheFrameAndNothingElse) {
  const TemporaryDirectory directory;
  const MapCopy map = room();
  write_outputs(map, {}, directory.file("plain"));
  write_outputs(map, {}, directory.file("aligned"),
                {.resolution_m = 0.05, .align = {10, 20, std::numbers::pi / 2}});

  EXPECT_TRUE(
      lines(directory.file("plain/trajectories/R1.tum"))[0].starts_with("1.000000 1.000000 1.000000 "));
  EXPECT_TRUE(
      lines(directory.file("aligned/trajectories/R1.tum"))[0].starts_with("1.000000 9.000000 21.000000 "));
  EXPECT_EQ(content(directory.file("plain/relations.csv")), content(directory.file("aligned/relations.csv")));
  // A quarter turn of a room on cell boundaries exchanges the sides of its grid.
  const Pgm plain = read_pgm(directory.file("plain/island-0.pgm"));
  const Pgm turned = read_pgm(directory.file("aligned/island-0.pgm"));
  EXPECT_NEAR(plain.width, turned.height, 1);
  EXPECT_NEAR(plain.height, turned.width, 1);
  const std::string sha = "\"map_sha256\": \"" + map_sha256(map) + "\"";
  EXPECT_NE(content(directory.file("plain/report.json")).find(sha), std::string::npos);
  EXPECT_NE(content(directory.file("aligned/report.json")).find(sha), std::string::npos);
}

TEST(WriteOutputs, WhatAnEarlierExportLeftIsRemoved) {
  const TemporaryDirectory directory;
  MapCopy two = room();
  two.graph.remove(two.graph.between(PatchId{0}, PatchId{1}).front());
  two.sessions.push_back({"R9", 1, 0, 0, PatchId{}});
  write_outputs(two, {}, directory.path());
  ASSERT_TRUE(fs::exists(directory.file("island-1.pgm")));
  ASSERT_TRUE(fs::exists(directory.file("trajectories/R9.tum")));
  for (const char* name : {"island-7.txt", "island-x.pgm", "notes.md", "trajectories/notes.md"}) {
    std::ofstream(directory.file(name)) << "mine";
  }
  write_outputs(room(), {}, directory.path());
  for (const char* name :
       {"island-1.pgm", "island-1.yaml", "island-1.png", "island-1-trajectory.png", "trajectories/R9.tum"}) {
    EXPECT_FALSE(fs::exists(directory.file(name))) << name;
  }
  for (const char* name :
       {"island-0.pgm", "island-7.txt", "island-x.pgm", "notes.md", "trajectories/notes.md"}) {
    EXPECT_TRUE(fs::exists(directory.file(name))) << name;
  }
}

TEST(WriteOutputs, TheSameMapGivesTheSameBytes) {
  const TemporaryDirectory directory;
  write_outputs(room(), {}, directory.file("a"));
  write_outputs(room(), {}, directory.file("b"));
  for (const std::string& name : names_in(directory.file("a"))) {
    EXPECT_EQ(content(directory.file("a/" + name)), content(directory.file("b/" + name))) << name;
  }
}

}  // namespace
}  // namespace isthmus
