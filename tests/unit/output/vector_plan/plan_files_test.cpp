#include "server/output/vector_plan/plan_files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;
using testing::content;
using testing::map_of;
using testing::rectangle;
using testing::TemporaryDirectory;

VectorPlan small_plan() {
  VectorPlan plan;
  plan.walls = {{{0, 0}, {4, 0}, 0.01, 5}, {{5, 0}, {9, 0}, 0.02, 3}};
  plan.openings = {{{4, 0}, {5, 0}}};
  plan.poles = {{{2, 3}, 0.15, true, 0.01, 4}};
  return plan;
}

/// The groups of a DXF file: code and value.
std::vector<std::pair<int, std::string>> groups(const std::string& text) {
  std::istringstream lines(text);
  std::vector<std::pair<int, std::string>> all;
  for (std::string code, value; std::getline(lines, code) && std::getline(lines, value);)
    all.emplace_back(std::stoi(code), value);
  return all;
}

TEST(PlanFiles, GeoJsonIsACollectionOfLinesAndPointsInTheIslandsFrame) {
  const Json json = Json::parse(plan_geojson(small_plan(), "metres"));
  EXPECT_EQ(json.at("type"), "FeatureCollection");
  EXPECT_EQ(json.at("coordinate_frame"), "metres; not WGS 84");
  ASSERT_EQ(json.at("features").size(), 4u);
  const Json wall = json.at("features")[0];
  EXPECT_EQ(wall.at("type"), "Feature");
  EXPECT_EQ(wall.at("geometry").at("type"), "LineString");
  EXPECT_EQ(wall.at("geometry").at("coordinates"), Json::parse("[[0,0],[4,0]]"));
  EXPECT_EQ(wall.at("properties").at("kind"), "wall");
  EXPECT_EQ(wall.at("properties").at("views"), 5);
  EXPECT_EQ(json.at("features")[2].at("properties").at("kind"), "opening");
  EXPECT_EQ(json.at("features")[3].at("geometry").at("coordinates"), Json::parse("[2,3]"));
  EXPECT_EQ(json.at("features")[3].at("properties").at("radius_m"), 0.15);
}

TEST(PlanFiles, DxfHasItsLayersAndAnEntityForEachThing) {
  const auto all = groups(plan_dxf(small_plan(), "metres"));
  std::map<std::pair<std::string, std::string>, int> entities;  // by kind and layer
  int depth = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] == std::pair(0, std::string("SECTION"))) ++depth;
    if (all[i] == std::pair(0, std::string("ENDSEC"))) --depth;
    if (all[i].first == 0 && (all[i].second == "LINE" || all[i].second == "CIRCLE"))
      ++entities[{all[i].second, all.at(i + 1).second}];
  }
  EXPECT_EQ(depth, 0);
  EXPECT_EQ(all.back().second, "EOF");
  EXPECT_EQ((entities[{"LINE", "WALLS"}]), 2);
  EXPECT_EQ((entities[{"LINE", "OPENINGS"}]), 1);
  EXPECT_EQ((entities[{"CIRCLE", "POLES"}]), 1);
  EXPECT_NE(std::find(all.begin(), all.end(), std::pair(1, std::string("AC1009"))), all.end());
}

TEST(PlanFiles, ARoomIsFourWallsInEachFile) {
  const TemporaryDirectory directory;
  const MapCopy map = map_of(rectangle(0, 0, 6, 4), {{1, 1, 0}, {2, 2, 0.5}, {4, 2, 1}, {3, 3, -0.25}});
  write_plans(map, directory.path());
  const Json json = Json::parse(content(directory.file("island-0-plan.geojson")));
  ASSERT_EQ(json.at("features").size(), 4u);
  double length_m = 0;
  for (const Json& wall : json.at("features")) {
    const Json& ends = wall.at("geometry").at("coordinates");
    length_m += std::hypot(ends[0][0].get<double>() - ends[1][0].get<double>(),
                           ends[0][1].get<double>() - ends[1][1].get<double>());
  }
  EXPECT_NEAR(length_m, 20, 0.02);
  EXPECT_EQ(groups(content(directory.file("island-0-plan.dxf"))).back().second, "EOF");
  const std::string svg = content(directory.file("island-0-plan.svg"));
  EXPECT_TRUE(svg.starts_with("<svg "));
  EXPECT_NE(svg.find(" m</text>"), std::string::npos);
}

TEST(PlanFiles, AMapWithoutWallsIsAnEmptyPlan) {
  const TemporaryDirectory directory;
  write_plans(map_of({}, {{0, 0, 0}}), directory.path());
  EXPECT_TRUE(Json::parse(content(directory.file("island-0-plan.geojson"))).at("features").empty());
}

}  // namespace
}  // namespace isthmus
