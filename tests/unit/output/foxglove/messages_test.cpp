#include "server/output/foxglove/messages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "server/output/foxglove/base64.hpp"

namespace isthmus::foxglove {
namespace {

using Json = nlohmann::json;

std::string encoded(const std::string& text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// The examples of RFC 4648, section 10.
TEST(Base64, IsThatOfTheStandard) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfd"), "//79");
}

/// 2 1 from the top; a viewer counts rows from the lowest y on.
///    # ?      100 255
///    . .        0   0
TEST(FoxgloveGrid, BeginsAtTheLowestRow) {
  OccupancyGrid cells;
  cells.resolution_m = 0.5;
  cells.origin_x_m = -3;
  cells.width = 2;
  cells.height = 2;
  cells.pixels = {OccupancyGrid::occupied, OccupancyGrid::unknown, OccupancyGrid::free, OccupancyGrid::free};
  const Json message = Json::parse(grid(0, cells, "island-0"));
  EXPECT_EQ(message.at("data"), encoded(std::string("\0\0\x64\xff", 4)));
  EXPECT_EQ(message.at("column_count"), 2);
  EXPECT_EQ(message.at("pose").at("position").at("x"), -3);
  EXPECT_EQ(message.at("cell_size").at("y"), 0.5);
}

TEST(FoxgloveLaserScan, WhatSaysNothingIsZero) {
  const Laser laser{Pose{}, 0.1, 30};
  constexpr float none = std::numeric_limits<float>::infinity();
  const Scan scan{1'500'000, -1, 0.5, {1.23456F, none, 30, 0.05F, std::nanf("")}};
  const Json message = Json::parse(laser_scan(scan, laser, "R1/laser"));
  EXPECT_EQ(message.at("ranges"), Json::parse("[1.235, 0.0, 0.0, 0.0, 0.0]"));
  EXPECT_EQ(message.at("start_angle"), -1);
  EXPECT_EQ(message.at("end_angle"), 1);  // of the last beam
  EXPECT_EQ(message.at("timestamp").at("sec"), 1);
  EXPECT_EQ(message.at("timestamp").at("nsec"), 500'000'000);
}

TEST(FoxgloveTransforms, TurnAboutTheVertical) {
  const double quarter = std::acos(0.0);
  const Json one = Json::parse(frame_transforms(-5, {{"map", "R1", {1, 2, quarter}}})).at("transforms").at(0);
  EXPECT_NEAR(one.at("rotation").at("z").get<double>(), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(one.at("rotation").at("w").get<double>(), std::sqrt(0.5), 1e-6);
  EXPECT_EQ(one.at("translation").at("y"), 2);
  EXPECT_EQ(one.at("timestamp").at("sec"), 0);  // there is no time before 1970
}

TEST(FoxgloveScene, IslandsThatAreGoneAreTakenAway) {
  Scene scene;
  scene.frame = "island-0";
  scene.tags = {{{1, 2}, "17"}};
  scene.closures = {{{0, 0}, {3, 4}}};
  const Json message = Json::parse(scene_update(0, {scene}, {"island-9"}));
  EXPECT_EQ(message.at("deletions").at(0).at("id"), "island-9");
  const Json& entity = message.at("entities").at(0);
  EXPECT_EQ(entity.at("id"), "island-0");
  EXPECT_EQ(entity.at("texts").at(0).at("text"), "17");
  EXPECT_EQ(entity.at("lines").at(0).at("points").size(), 2U);
}

/// Each field of a message is one of its schema, so that viewers read it.
TEST(FoxgloveSchemas, NameTheFieldsOfMessages) {
  OccupancyGrid cells;
  const std::vector<std::pair<Kind, std::string>> messages = {
      {Kind::frame_transforms, frame_transforms(0, {})},  {Kind::pose_in_frame, pose_in_frame(0, "map", {})},
      {Kind::laser_scan, laser_scan({}, {}, "R1/laser")}, {Kind::grid, grid(0, cells, "island-0")},
      {Kind::scene_update, scene_update(0, {})},          {Kind::log, log(0, Level::info, "text")}};
  for (const auto& [kind, text] : messages) {
    const Json fields = Json::parse(schema(kind).text).at("properties");
    const Json message = Json::parse(text);
    EXPECT_EQ(fields.size(), message.size()) << schema(kind).name;
    for (const auto& [name, value] : message.items()) EXPECT_TRUE(fields.contains(name)) << name;
  }
}

}  // namespace
}  // namespace isthmus::foxglove
