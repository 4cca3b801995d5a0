#include "server/wire/intake/event_clock.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "server/wire/live/live_server.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/published.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t second_us = 1'000'000;
constexpr std::int64_t five_hours_us = 5 * 3600 * second_us;

/// A machine's two clocks, moved by hand.
struct Clocks {
  std::int64_t wall_us = 1'000'000'000;
  std::int64_t monotonic_us = 777'000;

  void pass(std::int64_t us) {
    wall_us += us;
    monotonic_us += us;
  }
  std::shared_ptr<EventClock> event_clock() {
    return std::make_shared<EventClock>([this] { return wall_us; }, [this] { return monotonic_us; });
  }
};

TEST(EventClock, BeginsWithTheWallClockAndGoesOnWithTheMonotonicOne) {
  Clocks clocks;
  const auto clock = clocks.event_clock();
  EXPECT_EQ(clock->now(), 1'000'000'000);
  clocks.pass(5 * second_us);
  EXPECT_EQ(clock->now(), 1'005'000'000);
  for (const std::int64_t step_us : {five_hours_us, -2 * five_hours_us}) {
    clocks.wall_us += step_us;
    clocks.pass(second_us);
    EXPECT_EQ(clock->take_step(), step_us);
    EXPECT_EQ(clock->take_step(), std::nullopt) << "each is told once";
  }
  EXPECT_EQ(clock->now(), 1'007'000'000);
}

// As a clock that is kept right by a time server: 500 ppm.
TEST(EventClock, SlowDriftIsNoStepHoweverLong) {
  Clocks clocks;
  const auto clock = clocks.event_clock();
  for (int s = 0; s < 24 * 3600; ++s) {
    clocks.pass(second_us);
    clocks.wall_us += 500;
    ASSERT_EQ(clock->take_step(), std::nullopt);
  }
  EXPECT_EQ(clock->now(), 1'000'000'000 + 24 * 3600 * second_us);
}

TEST(EventClock, GoesOnFromALaterTimeAndNeverBack) {
  Clocks clocks;
  const auto clock = clocks.event_clock();
  EXPECT_EQ(clock->go_on_from(1'000'000'000 + five_hours_us), five_hours_us);
  EXPECT_EQ(clock->now(), 1'000'000'000 + five_hours_us);
  EXPECT_EQ(clock->go_on_from(5), 0);
  clocks.pass(second_us);
  EXPECT_EQ(clock->now(), 1'001'000'000 + five_hours_us);
  EXPECT_EQ(clock->take_step(), std::nullopt) << "it is not the wall clock that was set";
}

/// A team of two that is served while the wall clock is set.
class StepsOfTheWallClock : public ::testing::Test {
 protected:
  /// `steps`: by how much the wall clock is set before a round of the team's, of so many rounds. Robots stamp
  /// by clocks of their own.
  MapCopy serve(const std::map<int, std::int64_t>& steps, int rounds, int from_round = 0) {
    LiveOptions options = quick_options();
    options.clock = clocks_.event_clock();
    options.tick_interval = std::chrono::hours(1);  // no tick by the test's own pace
    options.journal_directory = directory_ / "journal";
    Inbox inbox({}, InboxOrder::arrival, [clock = options.clock] { return clock->now(); });
    LiveServer server(options, inbox, [](const auto&, const auto&) {});
    const auto push = [&](const std::string& name, const Message& message) {
      inbox.push(name, message.channel.ends_with("_SCAN"), clocks_.wall_us, message.channel, message.bytes);
    };
    const BoxRoomRobot first("R1"), second("R2");
    push("R1", first.introduction());
    push("R2", second.introduction());
    for (int i = from_round; i < from_round + rounds; ++i) {
      if (const auto step = steps.find(i); step != steps.end()) clocks_.wall_us += step->second;
      clocks_.pass(100'000);
      for (const Message& message : first.round(i)) push("R1", message);
      for (const Message& message : second.round(i)) push("R2", message);
    }
    inbox.close();
    server.run();
    return server.engine().copy();
  }

  TemporaryDirectory directory_;
  Clocks clocks_;
};

TEST_F(StepsOfTheWallClock, ForwardAndBackByFiveHoursTheMapIsTheSame) {
  const MapCopy stepped = serve({{30, five_hours_us}, {60, -five_hours_us}, {90, -five_hours_us}}, 150);
  clocks_ = {};
  std::filesystem::rename(directory_ / "journal", directory_ / "stepped");
  const MapCopy steady = serve({}, 150);
  EXPECT_GT(steady.counters.scans_matched, 250);
  EXPECT_EQ(map_sha256(stepped), map_sha256(steady));
  EXPECT_EQ(stepped.counters.last_receive_utime, steady.counters.last_receive_utime);
  EXPECT_TRUE(stepped.counters.dropped.empty());
  EXPECT_EQ(replay_of(directory_ / "stepped").sha256, map_sha256(steady));
}

TEST_F(StepsOfTheWallClock, EventTimePassesBetweenAllMessages) {
  serve({{10, five_hours_us}, {20, -2 * five_hours_us}}, 40);
  const std::vector<Message> messages = read_log(directory_ / "journal").messages;
  ASSERT_EQ(messages.size(), 3U + 4 * 40U);
  EXPECT_EQ(messages.front().utime, 1'000'000'000);
  EXPECT_EQ(messages.back().utime, 1'000'000'000 + 40 * 100'000);
}

TEST_F(StepsOfTheWallClock, AWallClockBehindTheJournalGoesOnFromItsEnd) {
  serve({}, 50);
  const std::int64_t ended = read_log(directory_ / "journal").messages.back().utime;
  clocks_.wall_us -= five_hours_us;
  const MapCopy map = serve({}, 50, 50);
  EXPECT_EQ(map.counters.scans, 200);
  const std::int64_t last = read_log(directory_ / "journal").messages.back().utime;
  EXPECT_GE(last, ended + 49 * 100'000) << "time stands still";
  EXPECT_LE(last, ended + 51 * 100'000);
  EXPECT_EQ(replay_of(directory_ / "journal").sha256, map_sha256(map));
}

}  // namespace
}  // namespace isthmus
