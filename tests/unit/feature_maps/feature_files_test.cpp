#include "server/feature_maps/output/feature_files.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/feature_events.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

/// One robot with a wall before it that it sees whole, and a landmark that is told of.
FeatureMaps small_map(FeatureMapKind kind) {
  testing::FeatureEvents run;
  run.declare("R1", 101, 20);
  run.tag(7);
  for (int i = 0; i < 3; ++i) {
    run.odometry("R1", {0.2 * i, 0, 0});
    run.scan("R1", {{{4, 1.5}, {4, -1.5}}, {{9, 6}, {9, -6}}}, {0.2 * i, 0, 0});
    run.sighting("R1", 7, {2 - 0.2 * i, 1});
    run.wait(1);
  }
  FeatureMapper mapper(feature_map_options(kind));
  for (const Event& event : run.events) mapper.handle(event);
  mapper.finish();
  return mapper.maps();
}

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> all;
  std::istringstream row(line);
  for (std::string field; std::getline(row, field, ',');) all.push_back(field);
  return all;
}

TEST(FeatureFiles, ARowTellsAWallWithTheCovarianceOfWhatIsKnown) {
  std::istringstream text(features_csv(small_map(FeatureMapKind::segments)));
  std::string line;
  std::getline(text, line);
  const std::size_t columns = fields(line).size();
  std::vector<std::string> row;  // of the nearer wall
  while (std::getline(text, line))
    if (fields(line).at(2) == "segment" && std::stod(fields(line).at(4)) < 5) row = fields(line);
  ASSERT_EQ(row.size(), columns);
  EXPECT_EQ(row[2], "segment");
  EXPECT_NEAR(std::stod(row[4]), 4, 0.01);     // ax
  EXPECT_NEAR(std::stod(row[5]), -1.5, 0.05);  // the observer has a on the right
  EXPECT_NEAR(std::stod(row[7]), 1.5, 0.05);
  EXPECT_EQ(row[8], "nan");             // no radius
  EXPECT_EQ(row[9], "3");               // seen
  EXPECT_GT(std::stod(row[10]), 0);     // of α
  EXPECT_GT(std::stod(row.back()), 0);  // of d_B: both ends are seen
}

TEST(FeatureFiles, ALandmarkHasItsBarcode) {
  std::istringstream text(features_csv(small_map(FeatureMapKind::points)));
  std::string line;
  std::getline(text, line);
  std::getline(text, line);
  const auto row = fields(line);
  EXPECT_EQ(row[2], "point");
  EXPECT_EQ(row[3], "7");
  EXPECT_NEAR(std::stod(row[4]), 2, 1e-6);
  EXPECT_EQ(row[6], "nan");
  EXPECT_EQ(row.back(), "nan");
}

TEST(FeatureFiles, OutputsHaveWhatTheContractAsks) {
  const TemporaryDirectory directory;
  const FeatureMaps maps = small_map(FeatureMapKind::segments);
  write_outputs(maps, {}, directory / "map");
  for (const char* name :
       {"features.csv", "robots.csv", "sightings.csv", "tags.csv", "report.json", "island-0-plan.svg",
        "island-0-plan.dxf", "island-0-plan.geojson", "trajectories/R1.tum"})
    EXPECT_TRUE(std::filesystem::exists(directory / "map/" + name)) << name;
  EXPECT_EQ(content(directory / "map/features.csv"), features_csv(maps));
  EXPECT_EQ(content(directory / "map/robots.csv"), "robot,island,from_s,to_s\nR1,0,1.000000,3.000000\n");
  const auto report = nlohmann::json::parse(content(directory / "map/report.json"));
  EXPECT_EQ(report.at("estimator"), "segments");
  EXPECT_EQ(report.at("scans"), 3);
  EXPECT_EQ(report.at("sightings").at("used"), 3);  // of a tag
  EXPECT_EQ(report.at("map_sha256"), map_sha256(maps));
}

}  // namespace
}  // namespace isthmus
