#include "server/wire/live/live_server.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <memory>
#include <thread>

#include "isthmus/manifold_pose_t.hpp"
#include "isthmus/status_t.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/failing_disk.hpp"
#include "tests/support/published.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/waiting.hpp"
#include "tests/unit/wire/live/live_inputs.hpp"

namespace isthmus {
namespace {

/// A server on a disk that fails, and a robot's rounds of odometry and scan handled before and after.
class LiveServerOnFailingDisk : public ::testing::Test {
 protected:
  std::unique_ptr<LiveServer> start(std::int64_t waiting_bytes = 64 * 1024 * 1024) {
    LiveOptions options = quick_options();
    options.journal_directory = directory_ / "journal";
    options.journal.disk = disk_.operations();
    options.journal.waiting_bytes = waiting_bytes;
    return std::make_unique<LiveServer>(options, inbox_, published_.sink());
  }
  /// Returns a status of the time when all of them were handled.
  status_t rounds(int from, int to) {
    for (int i = from; i < to; ++i) {
      for (const Message& message : robot_.round(i)) push(inbox_, "R1", message);
    }
    EXPECT_TRUE(happens([&] { return inbox_.size() == 0; })) << "rounds are not handled";
    const std::size_t known = published_.of<status_t>("ISTHMUS_STATUS").size();
    std::vector<status_t> all;
    EXPECT_TRUE(happens([&] {
      all = published_.of<status_t>("ISTHMUS_STATUS");
      return all.size() > known + 1;
    })) << "no status";
    if (all.empty()) return {};
    return all.back();  // the one before may have been on its way
  }

  TemporaryDirectory directory_;
  FailingDisk disk_;
  BoxRoomRobot robot_{"R1"};
  Published published_;
  Inbox inbox_;
};

TEST_F(LiveServerOnFailingDisk, LosesNothingToADiskThatIsFullForAWhile) {
  const auto server = start();
  std::thread engine_thread([&] { server->run(); });
  push(inbox_, "R1", robot_.introduction());
  rounds(0, 50);
  disk_.refuse_with(ENOSPC);
  EXPECT_GE(rounds(50, 100).journal_waiting, 100) << "and ticks";
  EXPECT_EQ(published_.of<manifold_pose_t>("R1_POSE").size(), 100U) << "robots are answered meanwhile";
  disk_.refuse_with(0);
  rounds(100, 150);
  inbox_.close();
  engine_thread.join();
  const MapCopy map = server->engine().copy();
  EXPECT_TRUE(map.counters.dropped.empty());
  const Replayed replayed = replay_of(directory_ / "journal");
  EXPECT_GE(replayed.events, 2U + 300U);
  EXPECT_EQ(replayed.sha256, map_sha256(map));
}

TEST_F(LiveServerOnFailingDisk, RefusesEventsBeforeTheEngineHasThemWhereNoMoreCanWait) {
  const auto server = start(20'000);
  std::thread engine_thread([&] { server->run(); });
  push(inbox_, "R1", robot_.introduction());
  rounds(0, 50);
  disk_.refuse_with(ENOSPC);
  rounds(50, 150);
  disk_.refuse_with(0);
  const status_t status = rounds(150, 200);
  inbox_.close();
  engine_thread.join();
  const MapCopy map = server->engine().copy();
  const std::int64_t refused = map.counters.dropped_by_robot.at("R1").at(DropReason::journal_full);
  EXPECT_GT(refused, 100);
  ASSERT_EQ(status.robots.size(), 1U);
  ASSERT_EQ(status.robots[0].dropped.size(), 1U);
  EXPECT_EQ(status.robots[0].dropped[0].reason, "journal_full");
  const Replayed replayed = replay_of(directory_ / "journal");
  EXPECT_GE(replayed.events + static_cast<std::size_t>(refused), 2U + 400U);
  EXPECT_EQ(replayed.sha256, map_sha256(map));
}

TEST_F(LiveServerOnFailingDisk, SaysWhatTheJournalLacksWhereTheDiskIsFullForGood) {
  const auto server = start();
  push(inbox_, "R1", robot_.introduction());
  disk_.refuse_with(ENOSPC);
  inbox_.close();
  EXPECT_EQ(error_of([&] { server->run(); }),
            directory_ / "journal" +
                ": events that the disk refused to the end: 1; the map has them, the journal does not");
}

TEST_F(LiveServerOnFailingDisk, DoesNotBeginAJournalThatTheDiskRefuses) {
  disk_.refuse_with(EROFS);
  EXPECT_EQ(error_of([&] { start(); }),
            directory_ / "journal" + ": the disk refuses the journal's first event");
}

}  // namespace
}  // namespace isthmus
