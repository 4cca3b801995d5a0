// A server that is told to stop ends in the time that it is given, with results.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "server/wire/live/live_server.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/published.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

using std::chrono::seconds;

class Stop : public ::testing::Test {
 protected:
  Stop() {
    options_.tick_interval = std::chrono::hours(1);
    options_.journal_directory = directory_ / "journal";
    options_.output_directory = directory_ / "out";
  }
  void send(int rounds) {
    const BoxRoomRobot robot("R1");
    push(robot.introduction());
    for (int i = 0; i < rounds; ++i)
      for (const Message& message : robot.round(i)) push(message);
  }
  void push(const Message& message) {
    inbox_.push("R1", message.channel.ends_with("_SCAN"), message.utime, message.channel, message.bytes);
  }
  nlohmann::json report() const {
    std::ifstream file(directory_ / "out/report.json");
    return file ? nlohmann::json::parse(file) : nlohmann::json();
  }

  TemporaryDirectory directory_;
  LiveOptions options_ = quick_options();
  Inbox inbox_{{}, InboxOrder::arrival};
};

TEST_F(Stop, InGoodTimeTheMapIsFinished) {
  send(50);
  inbox_.close();
  LiveServer server(options_, inbox_, [](const auto&, const auto&) {});
  server.stop_within(seconds(600));
  server.run();
  EXPECT_EQ(report().at("finished"), true);
  EXPECT_EQ(report().at("scans"), 50);
  EXPECT_EQ(report().at("map_sha256"), replay_of(directory_ / "journal").sha256);
}

TEST_F(Stop, WithoutTimeThereAreResultsAndWhatWasLeftIsCounted) {
  send(50);
  inbox_.close();
  nlohmann::json when_time_was_up;
  options_.log = [&](LogLevel, std::string_view message, const LogFields&) {
    if (message.starts_with("no time to finish")) when_time_was_up = report();
  };
  LiveServer server(options_, inbox_, [](const auto&, const auto&) {});
  server.stop_within(seconds(0));
  server.run();
  ASSERT_TRUE(when_time_was_up.is_object()) << "no results before the map is finished";
  EXPECT_EQ(when_time_was_up.at("finished"), false);
  EXPECT_EQ(report().at("finished"), false);
  EXPECT_EQ(report().at("dropped").at("stopped"), 101);
}

TEST_F(Stop, WhileTheJournalIsMappedAgainThereAreResultsOfAsMuch) {
  send(50);
  inbox_.close();
  LiveServer(options_, inbox_, [](const auto&, const auto&) {}).run();
  Inbox inbox({}, InboxOrder::arrival);
  inbox.close();
  LiveServer server(options_, inbox, [](const auto&, const auto&) {});
  server.stop_within(seconds(0));
  server.run();
  EXPECT_EQ(report().at("finished"), false);
  EXPECT_LT(report().at("scans"), 50);
}

}  // namespace
}  // namespace isthmus
