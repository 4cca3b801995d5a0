#include "tools/export/mcap/map_mcap.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "server/engine/engine.hpp"
#include "server/wire/message/server_configuration.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/export/mcap/mcap_file.hpp"

namespace isthmus {
namespace {

using testing::McapFile;
using Json = nlohmann::json;

constexpr int rounds = 40;

std::vector<Message> drive() {
  const BoxRoomRobot robot("R1", 7);
  std::vector<Message> messages = {robot.introduction()};
  for (int i = 1; i <= rounds; ++i)
    for (Message& message : robot.round(i)) messages.push_back(std::move(message));
  return messages;
}

Engine mapped(const std::vector<Message>& messages) {
  Engine engine;
  for (const Message& message : messages)
    engine.handle(*decode({}, message.channel, message.bytes, message.utime).event);
  engine.finish();
  return engine;
}

/// One robot's drive through a box, as MCAP.
class MapMcap : public ::testing::Test {
 protected:
  McapFile written(McapOptions options) const {
    const std::string path = directory_ / "run.mcap";
    counted_ = write_mcap(engine_.copy(), engine_.configuration(), path, options);
    return read(path);
  }
  static McapFile read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream bytes;
    bytes << file.rdbuf();
    return testing::read_mcap(bytes.str());
  }
  McapFile with_scans() const {
    write_log(directory_ / "run.lcm", drive());
    McapOptions options;
    options.log = directory_ / "run.lcm";
    return written(options);
  }

  TemporaryDirectory directory_;
  Engine engine_ = mapped(drive());
  mutable std::uint64_t counted_ = 0;
};

TEST_F(MapMcap, HasEachScanAndPoseWithItsStamp) {
  const McapFile file = with_scans();
  EXPECT_EQ(file.messages.size(), counted_);
  const auto scans = file.of_topic("/R1/scan"), poses = file.of_topic("/R1/pose");
  ASSERT_EQ(scans.size(), static_cast<std::size_t>(rounds));
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(rounds));
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Json scan = Json::parse(scans[i].data), pose = Json::parse(poses[i].data);
    const auto ns = scan.at("timestamp").at("sec").get<std::uint64_t>() * 1'000'000'000 +
                    scan.at("timestamp").at("nsec").get<std::uint64_t>();
    EXPECT_EQ(ns, scans[i].log_time_ns);
    EXPECT_EQ(ns, (1'000'000'000U + 100'000U * (i + 1)) * 1000);
    EXPECT_EQ(poses[i].log_time_ns, ns);
    EXPECT_EQ(scan.at("frame_id"), "R1/laser");
    EXPECT_EQ(pose.at("frame_id"), "island-0");
  }
}

/// It drives 0.05 m a round along x, from 1.05 m on, and looks to and fro; its first heading is the map's.
TEST_F(MapMcap, PosesAndTransformsHaveTheRobotWhereItDrove) {
  const McapFile file = with_scans();
  std::vector<Json> places, turns;
  for (const auto& message : file.of_topic("/R1/pose"))
    places.push_back(Json::parse(message.data).at("pose").at("position"));
  for (const auto& message : file.of_topic("/tf")) {
    const Json first = Json::parse(message.data).at("transforms").at(0);
    if (first.at("child_frame_id") != "R1") continue;
    EXPECT_EQ(first.at("parent_frame_id"), "island-0");
    EXPECT_EQ(first.at("translation"), places.at(turns.size()));
    turns.push_back(first.at("rotation"));
  }
  ASSERT_EQ(turns.size(), static_cast<std::size_t>(rounds));
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const double ahead_m = places[i].at("x").get<double>() - places[0].at("x").get<double>();
    const double yaw = 2 * std::atan2(turns[i].at("z").get<double>(), turns[i].at("w").get<double>());
    const auto round = static_cast<double>(i + 1);
    EXPECT_NEAR(ahead_m, 0.05 * (round - 1), 0.03) << i;
    EXPECT_NEAR(yaw, 0.3 * (std::sin(0.05 * round) - std::sin(0.05)), 0.02) << i;
  }
}

TEST_F(MapMcap, HasTheGridAndTheSchemas) {
  const McapFile file = with_scans();
  const auto grids = file.of_topic("/island-0/grid");
  ASSERT_EQ(grids.size(), 1U);
  const Json grid = Json::parse(grids.front().data);
  const auto columns = grid.at("column_count").get<std::size_t>();
  EXPECT_EQ(grid.at("row_stride"), columns);
  EXPECT_NEAR(static_cast<double>(columns), 7.4 / 0.05, 8);  // it looks ahead, from x = 1 m to 8 m
  for (const auto& [id, channel] : file.channels) {
    EXPECT_EQ(channel.encoding, "json");
    const McapFile::Schema& schema = file.schemas.at(channel.schema);
    EXPECT_EQ(schema.encoding, "jsonschema");
    EXPECT_TRUE(schema.name.starts_with("foxglove."));
    EXPECT_EQ(Json::parse(schema.text).at("type"), "object");
  }
  EXPECT_EQ(file.of_topic("/scene").size(), 1U);
}

TEST_F(MapMcap, WithoutALogThereAreNoScans) {
  const McapFile file = written({});
  for (const auto& [id, channel] : file.channels) EXPECT_NE(channel.topic, "/R1/scan");
  EXPECT_EQ(file.of_topic("/R1/pose").size(), static_cast<std::size_t>(rounds));
}

/// Messages came years after the robots' stamps; so it is of logs that are played again.
TEST_F(MapMcap, TheLogHasTheTimeOfTheRobots) {
  constexpr std::int64_t first_utime = 1'000'000'000, step_us = 100'000, later_us = 1'000'000'000'000;
  std::vector<Message> messages = drive();
  for (Message& message : messages) message.utime += later_us;
  write_log(directory_ / "run.lcm", messages);
  MapCopy map = engine_.copy();
  for (const int round : {10, 20}) {
    ClosureRecord& closure = map.closures.emplace_back();
    closure.id = ClosureId{round};
    closure.end_utime = later_us + first_utime + round * step_us;
  }
  McapOptions options;
  options.log = directory_ / "run.lcm";
  const std::string path = directory_ / "run.mcap";
  write_mcap(map, engine_.configuration(), path, options);
  const McapFile file = read(path);
  const auto told = file.of_topic("/log");
  ASSERT_EQ(told.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto utime = static_cast<std::int64_t>(told[i].log_time_ns / 1000);
    EXPECT_NEAR(static_cast<double>(utime - first_utime), 1e6 * static_cast<double>(i + 1), 2 * step_us) << i;
    EXPECT_EQ(Json::parse(told[i].data).at("timestamp").at("sec"), utime / 1'000'000);
  }
}

TEST_F(MapMcap, TheSameMapIsTheSameFile) {
  McapOptions options;
  options.resolution_m = 0.1;
  write_mcap(engine_.copy(), engine_.configuration(), directory_ / "a", options);
  write_mcap(engine_.copy(), engine_.configuration(), directory_ / "b", options);
  EXPECT_EQ(read_bytes(directory_ / "a"), read_bytes(directory_ / "b"));
}

TEST_F(MapMcap, NothingIsLeftWhereTheLogCannotBeRead) {
  McapOptions options;
  options.log = directory_ / "none.lcm";
  EXPECT_THROW(write_mcap(engine_.copy(), engine_.configuration(), directory_ / "a.mcap", options),
               std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_empty(directory_ / ""));
}

}  // namespace
}  // namespace isthmus
