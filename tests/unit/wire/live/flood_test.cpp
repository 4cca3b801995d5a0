// One robot floods the server while another drives calmly: the calm one is answered as if it were alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "isthmus/manifold_pose_t.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/published.hpp"
#include "tests/support/waiting.hpp"
#include "tests/unit/wire/live/live_inputs.hpp"

namespace isthmus {
namespace {

using std::chrono::milliseconds;

/// Bounds that a flood reaches within the test.
InboxLimits small_limits() {
  InboxLimits limits;
  limits.messages = 2000;
  limits.bytes = 16 * 1024 * 1024;
  return limits;
}

/// A server, a flooder R2, and a calm R1. Of each of R1's scans it is noted how many of R2's were answered
/// between its sending and its answer. The count is read after the scan is in the inbox, so that it says what
/// the inbox made wait, not for how long the system held this test's thread up.
class Flood {
 public:
  Flood() : server_(quick_options(), inbox_, [this](const auto& channel, const auto&) { note(channel); }) {
    for (const std::string name : {"R1", "R2"}) {
      inbox_.introduce(name);  // as whoever receives does: what follows does not wait for the engine
      push(inbox_, name, BoxRoomRobot(name).introduction());
    }
  }

  /// R1 drives while the flooder's act is repeated as fast as it goes. It was done `before` times before the
  /// server starts, so that the flooder's queue is full whichever of the two is faster.
  void run(const std::function<void(Inbox&, std::int64_t)>& act, std::int64_t before, int rounds) {
    for (std::int64_t i = 0; i < before; ++i) act(inbox_, i);
    std::thread engine([this] { server_.run(); });
    std::atomic<bool> over = false;
    std::thread flooder([&] {
      for (std::int64_t i = before; !over; ++i) act(inbox_, i);
    });
    const BoxRoomRobot calm("R1");
    for (int i = 0; i < rounds; ++i) {
      for (const Message& message : calm.round(i)) push(inbox_, "R1", message);
      const std::int64_t sent_at = flood_answers_;
      if (!happens([&] { return answered() > static_cast<std::size_t>(i); })) break;
      between_.push_back(flood_answers_at(i) - sent_at);
    }
    over = true;
    flooder.join();
    inbox_.close();
    engine.join();
  }

  /// For each of R1's answers, how many of R2's came between its scan and it; below nought where it came
  /// first.
  std::vector<std::int64_t> between() const { return between_; }
  std::size_t answered() {
    const std::lock_guard lock(mutex_);
    return flood_answers_at_.size();
  }
  MapCopy map() const { return server_.engine().copy(); }

 private:
  void note(const std::string& channel) {
    if (channel == "R2_POSE") ++flood_answers_;
    if (channel != "R1_POSE") return;
    const std::lock_guard lock(mutex_);
    flood_answers_at_.push_back(flood_answers_);
  }

  std::int64_t flood_answers_at(int answer) {
    const std::lock_guard lock(mutex_);
    return flood_answers_at_.at(static_cast<std::size_t>(answer));
  }

  Inbox inbox_{small_limits()};
  std::atomic<std::int64_t> flood_answers_ = 0;
  std::mutex mutex_;
  std::vector<std::int64_t> flood_answers_at_;  // when each of R1's scans was answered
  std::vector<std::int64_t> between_;
  LiveServer server_;
};

constexpr int calm_rounds = 60;
/// Odometry and scan of the calm robot each wait for one message of the flooder, besides that at work.
constexpr std::int64_t max_between = 3;

void expect_calm(Flood& flood) {
  const std::vector<std::int64_t> between = flood.between();
  ASSERT_EQ(between.size(), static_cast<std::size_t>(calm_rounds)) << "every scan is answered";
  EXPECT_LE(*std::ranges::max_element(between), max_between);
  const auto& dropped = flood.map().counters.dropped_by_robot;
  EXPECT_FALSE(dropped.contains("R1"));
  EXPECT_TRUE(dropped.contains("R2"));
}

TEST(Flood, OfScansDelaysNobodyElse) {
  std::vector<Message> rounds;
  for (int i = 0; i < 500; ++i) {
    for (const Message& message : BoxRoomRobot("R2").round(i)) rounds.push_back(message);
  }
  Flood flood;
  const auto act = [&](Inbox& inbox, std::int64_t n) {
    push(inbox, "R2", rounds[static_cast<std::size_t>(n) % rounds.size()]);
  };
  flood.run(act, 10'000, calm_rounds);
  expect_calm(flood);
  EXPECT_GT(flood.map().counters.dropped_by_robot.at("R2").at(DropReason::queue_full), 0);
}

TEST(Flood, OfScansAMegabyteLongDelaysNobodyElse) {
  Scan scan{1'000'000'000, -1.5, 1e-5, std::vector<float>(250'000, 3.0F)};
  const Message large = encode({1, ScanEvent{"R2", scan}});
  ASSERT_GT(large.bytes.size(), 1'000'000U);
  Flood flood;
  flood.run([&](Inbox& inbox, std::int64_t) { push(inbox, "R2", large); }, 100, calm_rounds);
  expect_calm(flood);
}

// Robots that are not declared, each under a name of its own.
TEST(Flood, OfNamesDelaysNobodyElse) {
  Flood flood;
  const auto act = [&](Inbox& inbox, std::int64_t n) {
    const std::string name = "X" + std::to_string(n % 10'000);
    inbox.push(name, false, n, name + "_ODOMETRY", std::vector<std::uint8_t>(100));
    if (n % 100 == 0) inbox.count_drop("R2", DropReason::not_signed);
  };
  flood.run(act, 1000, calm_rounds);
  const std::vector<std::int64_t> between = flood.between();
  EXPECT_EQ(between.size(), static_cast<std::size_t>(calm_rounds));
  EXPECT_LE(flood.map().counters.dropped_by_robot.size(), 260U) << "names cost no memory for ever";
}

// R2 comes back from a radio shadow.
TEST(Backlog, OfTenMinutesIsTakenWholeAndInItsOwnOrder) {
  constexpr int rounds = 6000;  // ten a second
  Published published;
  Inbox inbox;
  LiveServer server(quick_options(), inbox, published.sink());
  const BoxRoomRobot robot("R2");
  push(inbox, "R2", robot.introduction());
  for (int i = 0; i < rounds; ++i) {
    for (const Message& message : robot.round(i)) push(inbox, "R2", message);
  }
  inbox.close();
  server.run();
  std::vector<std::int64_t> utimes;
  for (const auto& pose : published.of<manifold_pose_t>("R2_POSE")) utimes.push_back(pose.utime);
  EXPECT_EQ(utimes.size(), static_cast<std::size_t>(rounds));
  EXPECT_TRUE(std::is_sorted(utimes.begin(), utimes.end()));
  EXPECT_TRUE(server.engine().copy().counters.dropped.empty());
}

}  // namespace
}  // namespace isthmus
