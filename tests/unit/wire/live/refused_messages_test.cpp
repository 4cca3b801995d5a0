#include "server/wire/live/live_server.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <thread>

#include "server/wire/message/encoded.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/published.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/wire/live/live_inputs.hpp"

namespace isthmus {
namespace {

/// Without the records of what was dropped.
std::size_t events_in(const std::string& journal) {
  const std::vector<Message> messages = read_log(journal).messages;
  return static_cast<std::size_t>(std::count_if(messages.begin(), messages.end(),
                                                [](const Message& message) { return !read_drops(message); }));
}

TEST(LiveServer, CountsBadMessagesAndKeepsThemOutOfTheJournal) {
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  const BoxRoomRobot robot("R1");
  push(inbox, "R1", robot.introduction());
  for (const Message& message : robot.round(0)) push(inbox, "R1", message);
  push(inbox, "R1", {1, "R1_SCAN", {1, 2, 3}});
  push(inbox, "R1", {1, "R1_SCAN", robot.round(1)[0].bytes});
  push(inbox, "", {1, "CAMERA", {1, 2, 3}});
  push(inbox, "", encode({1, TickEvent{}}));
  push(inbox, "", encode({1, ConfigurationEvent{"tags = \"any\""}}));
  inbox.close();
  server.run();

  const MapCopy map = server.engine().copy();
  const std::map<DropReason, std::int64_t> expected = {
      {DropReason::bad_length, 1}, {DropReason::bad_fingerprint, 1}, {DropReason::bad_channel, 2}};
  EXPECT_EQ(map.counters.dropped, expected);
  EXPECT_FALSE(server.engine().configuration().any_tag);
  EXPECT_EQ(events_in(directory / "journal"), 4U) << "configuration, robot, odometry, scan";
  EXPECT_EQ(replay_of(directory / "journal").dropped, expected);
}

TEST(LiveServer, RefusesAStrangersMessagesBeforeTheJournal) {
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  for (const Message& message : BoxRoomRobot("R9").round(0)) push(inbox, "R9", message);
  inbox.close();
  server.run();
  const MapCopy map = server.engine().copy();
  EXPECT_EQ(map.counters.dropped.at(DropReason::unknown_robot), 2);
  EXPECT_TRUE(map.patches.empty());
  EXPECT_EQ(events_in(directory / "journal"), 1U) << "the configuration";
  EXPECT_EQ(replay_of(directory / "journal").sha256, map_sha256(map));
}

// What comes before a robot's first introduction is lost, and no more than that.
TEST(LiveServer, TakesARobotFromItsFirstIntroductionOn) {
  LiveOptions options = quick_options();
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  const BoxRoomRobot robot("R1");
  for (const Message& message : robot.round(0)) push(inbox, "R1", message);
  push(inbox, "R1", robot.introduction());
  for (int i = 1; i <= 3; ++i)
    for (const Message& message : robot.round(i)) push(inbox, "R1", message);
  inbox.close();
  server.run();
  const MapCopy map = server.engine().copy();
  EXPECT_EQ(map.counters.scans, 3);
  EXPECT_EQ(map.counters.dropped.at(DropReason::unknown_robot), 2);
}

// Odometry of 200,000 robots that there are not, each under a name of its own.
TEST(LiveServer, HoldsNothingOfMadeUpRobots) {
  constexpr int strangers = 200'000;
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  std::string metrics;
  options.metrics = [&](std::string text) { metrics = std::move(text); };
  options.status_interval = std::chrono::milliseconds(50);
  Inbox inbox;
  LiveServer server(options, inbox, [](const auto&, const auto&) {});
  std::thread engine([&] { server.run(); });
  Message message = BoxRoomRobot("R9").round(0)[0];
  for (int i = 0; i < strangers; ++i) {
    const std::string name = "X" + std::to_string(i);
    inbox.push_waiting(name, false, message.utime, name + "_ODOMETRY", message.bytes);
    inbox.count_drop(name, DropReason::bad_length);
  }
  inbox.close();
  engine.join();
  const Counters counters = server.engine().copy().counters;
  EXPECT_EQ(counters.dropped.at(DropReason::unknown_robot), strangers);
  EXPECT_EQ(counters.dropped_by_robot.at("(others)").at(DropReason::unknown_robot), strangers);
  EXPECT_LE(counters.dropped_by_robot.size(), 257U);
  EXPECT_LT(metrics.size(), 50'000U);
  EXPECT_EQ(events_in(directory / "journal"), 1U);
}

TEST(LiveServer, KeepsTheRobotsAndTagsThatItKnowsAndRefusesMore) {
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  options.admission = {2, 1};
  for (const int start : {1, 2}) {  // what the journal holds counts
    Published published;
    Inbox inbox;
    LiveServer server(options, inbox, published.sink());
    for (const std::string name : {"R1", "R2", "R3"}) push(inbox, name, BoxRoomRobot(name).introduction());
    for (const std::int32_t barcode : {7, 7, 8}) push(inbox, "", encode({1, TagEvent{1, barcode}}));
    inbox.close();
    server.run();
    const std::map<DropReason, std::int64_t> expected = {{DropReason::too_many_robots, start},
                                                         {DropReason::too_many_tags, start}};
    EXPECT_EQ(server.engine().copy().counters.dropped, expected);
  }
}

TEST(LiveServer, RefusesAWrongConfiguration) {
  LiveOptions options = quick_options();
  options.toml = "tags = 5";
  Inbox inbox;
  EXPECT_EQ(error_of([&] { LiveServer server(options, inbox, [](const auto&, const auto&) {}); }),
            "configuration:1: tags must be a string");
}

}  // namespace
}  // namespace isthmus
