// What a server had received when it was killed, a later one on the same journal handles.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <thread>

#include "isthmus/received_t.hpp"
#include "server/wire/journal/frames/spool_file.hpp"
#include "server/wire/journal/set_aside.hpp"
#include "server/wire/live/live_server.hpp"
#include "server/wire/trust/envelope.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/failing_disk.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/published.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/waiting.hpp"
#include "tests/unit/wire/live/live_inputs.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// Odometry and scan of rounds [from, to) of R1.
void drive(Inbox& inbox, int from, int to) {
  const BoxRoomRobot robot("R1");
  if (from == 0) push(inbox, "R1", robot.introduction());
  for (int i = from; i < to; ++i) {
    for (const Message& message : robot.round(i)) push(inbox, "R1", message);
  }
}

/// A server's life that ends in order, with nothing new received.
MapCopy serve(const LiveOptions& options) {
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  inbox.close();
  server.run();
  return server.engine().copy();
}

/// Holds the engine up at a scan until it is let go.
class Brake {
 public:
  std::function<void(const Event&)> hook() {
    return [this](const Event& event) {
      if (!std::holds_alternative<ScanEvent>(event.body)) return;
      held_ = true;
      while (holds_) std::this_thread::sleep_for(milliseconds(1));
    };
  }
  bool holds() const { return held_; }
  void let_go() { holds_ = false; }

 private:
  std::atomic<bool> holds_ = true;
  std::atomic<bool> held_ = false;
};

/// A server that runs in a thread of its own; the engine may be held up at its first scan.
class RunningServer {
 public:
  explicit RunningServer(LiveOptions options, bool braked = false, const InboxLimits& limits = {})
      : inbox(limits),
        server_(braked ? with_brake(std::move(options)) : std::move(options), inbox, published.sink()),
        thread_([this] { server_.run(); }) {}
  ~RunningServer() { end(); }

  /// In order, with all that it has received handled.
  void end() {
    brake.let_go();
    inbox.close();
    if (thread_.joinable()) thread_.join();
  }

  Brake brake;
  Published published;
  Inbox inbox;

 private:
  LiveOptions with_brake(LiveOptions options) {
    options.before_event = brake.hook();
    return options;
  }

  LiveServer server_;
  std::thread thread_;
};

/// What the disk has of a directory at this moment: what a process that is killed now leaves.
void copy_as_if_killed(const std::string& from, const std::string& to) {
  fs::copy(from, to, fs::copy_options::recursive);
}

/// How often each message of R1 is in a journal.
std::map<std::pair<std::string, std::vector<std::uint8_t>>, int> messages_in(const std::string& journal) {
  std::map<std::pair<std::string, std::vector<std::uint8_t>>, int> messages;
  for (const Message& message : read_log(journal).messages)
    if (message.channel.starts_with("R1_")) messages[{message.channel, message.bytes}] += 1;
  return messages;
}

void expect_each_once(const std::string& journal, std::size_t count) {
  const auto messages = messages_in(journal);
  EXPECT_EQ(messages.size(), count);
  for (const auto& [message, times] : messages) EXPECT_EQ(times, 1) << message.first;
}

/// The next server on a journal takes what R1 sent in so many rounds, each message once, and replay makes of
/// it the map that it made.
void expect_kept(const std::string& journal, std::size_t rounds) {
  const std::string map = map_sha256(serve(journalled(journal)));
  expect_each_once(journal, 1 + 2 * rounds);
  EXPECT_EQ(replay_of(journal).sha256, map);
}

TEST(KeptMessages, OutliveAKillWhileTheEngineIsFarBehind) {
  TemporaryDirectory directory;
  RunningServer server(journalled(directory / "journal"), true);
  drive(server.inbox, 0, 2410);
  copy_as_if_killed(directory / "journal", directory / "killed");
  server.end();
  expect_kept(directory / "killed", 2410);
}

TEST(KeptMessages, OutliveAKillWhileTheServerRecovers) {
  TemporaryDirectory directory;
  {
    RunningServer before(journalled(directory / "journal"));
    drive(before.inbox, 0, 50);
  }
  RunningServer server(journalled(directory / "journal"), true);
  ASSERT_TRUE(happens([&] { return server.brake.holds(); }));
  drive(server.inbox, 50, 150);
  copy_as_if_killed(directory / "journal", directory / "killed");
  server.end();
  expect_kept(directory / "killed", 150);
}

// Kills at any moment of a life, each followed by the next: nothing twice, nothing lost.
TEST(KeptMessages, AreTakenOnceHoweverOftenTheServerIsKilled) {
  TemporaryDirectory directory;
  std::string journal = directory / "0";
  for (int life = 0; life < 6; ++life) {
    RunningServer server(journalled(journal));
    drive(server.inbox, 40 * life, 40 * (life + 1));
    happens([&] { return server.inbox.size() <= 10U * static_cast<unsigned>(life); });
    const std::string next = directory / std::to_string(life + 1);
    copy_as_if_killed(journal, next);
    journal = next;
  }
  expect_kept(journal, 240);
}

TEST(KeptMessages, AreCountedAsDroppedAfterAKillWhereTheInboxWasFull) {
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  options.status_interval = milliseconds(1);
  InboxLimits limits;
  limits.messages = 20;
  RunningServer server(options, true, limits);
  drive(server.inbox, 0, 1);
  ASSERT_TRUE(happens([&] { return server.brake.holds(); }));
  drive(server.inbox, 1, 100);
  server.brake.let_go();
  const auto recorded = [&] {
    return replay_of(directory / "journal").dropped[DropReason::queue_full] >= 170;
  };
  ASSERT_TRUE(happens(recorded));
  copy_as_if_killed(directory / "journal", directory / "killed");
  server.end();

  const MapCopy map = serve(journalled(directory / "killed"));
  const auto dropped = static_cast<std::size_t>(map.counters.dropped.at(DropReason::queue_full));
  expect_each_once(directory / "killed", 1 + 2 * 100 - dropped);
  EXPECT_EQ(replay_of(directory / "killed").dropped, map.counters.dropped);
}

TEST(KeptMessages, StayForTheNextStartWhereTheServerStopsFirst) {
  TemporaryDirectory directory;
  RunningServer server(journalled(directory / "journal"));
  drive(server.inbox, 0, 20);
  server.end();
  expect_each_once(directory / "journal", 1 + 2 * 20);
  ASSERT_EQ(list_spool(directory / "journal").size(), 1U);
  EXPECT_LT(fs::file_size(list_spool(directory / "journal").begin()->second), 100U) << "all is settled";
}

// A sender that signs counts on: what was received and not handled keeps its counter, and is not taken again.
TEST(KeptMessages, KeepTheirSignatures) {
  TemporaryDirectory directory;
  AuthKey key{};
  key[0] = 1;
  std::string hex(64, '0');
  hex[1] = '1';
  LiveOptions options = journalled(directory / "journal");
  options.toml = "[auth.robots]\nR1 = \"" + hex + "\"\n";
  const BoxRoomRobot robot("R1");
  std::int64_t counter = 0;
  std::vector<Message> sealed = {seal(key, "R1", ++counter, robot.introduction())};
  for (int i = 0; i < 20; ++i) {
    for (const Message& message : robot.round(i)) sealed.push_back(seal(key, "R1", ++counter, message));
  }
  Brake brake;
  options.before_event = brake.hook();
  Published published;
  Inbox inbox;
  {
    LiveServer server(options, inbox, published.sink());
    Authenticator authenticator = server.authenticator();
    std::thread engine_thread([&] { server.run(); });
    for (const Message& envelope : sealed) {
      const Opened opened = authenticator.open(server.channels(), envelope.utime, envelope.bytes);
      ASSERT_TRUE(opened.message);
      push(inbox, "R1", *opened.message);
    }
    copy_as_if_killed(directory / "journal", directory / "killed");
    brake.let_go();
    inbox.close();
    engine_thread.join();
  }
  options.before_event = {};
  options.journal_directory = directory / "killed";
  for (int start = 0; start < 2; ++start) {
    Inbox next;
    LiveServer server(options, next, published.sink());
    Authenticator authenticator = server.authenticator();
    for (const Message& envelope : sealed) {
      const Opened opened = authenticator.open(server.channels(), envelope.utime, envelope.bytes);
      EXPECT_EQ(opened.reason, DropReason::replayed);
    }
    next.close();
    server.run();
  }
  expect_each_once(directory / "killed", 1 + 2 * 20);
}

TEST(KeptMessages, AreAcknowledgedToTheirSenders) {
  TemporaryDirectory directory;
  RunningServer server(journalled(directory / "journal"));
  drive(server.inbox, 0, 30);
  const auto all = [&] {
    const auto told = server.published.of<received_t>("ISTHMUS_RECEIVED");
    return !told.empty() && told.back().nchannels == 3 && told.back().channels[2].messages == 30;
  };
  EXPECT_TRUE(happens(all));
  const received_t told = server.published.of<received_t>("ISTHMUS_RECEIVED").back();
  ASSERT_EQ(told.nchannels, 3);
  EXPECT_EQ(told.channels[0].channel, "R1_ODOMETRY");
  EXPECT_EQ(told.channels[2].channel, "R1_SCAN");
  EXPECT_EQ(told.channels[2].newest_utime, 1'000'000'000 + 29 * 100'000);
}

TEST(KeptMessages, AreNotAcknowledgedWithoutAJournal) {
  Published published;
  Inbox inbox;
  LiveServer server(quick_options(), inbox, published.sink());
  drive(inbox, 0, 5);
  inbox.close();
  server.run();
  EXPECT_TRUE(published.of<received_t>("ISTHMUS_RECEIVED").empty());
}

/// A process that serves the journal, to whose engine R1's scan with the stamp of round `fatal` is fatal.
/// Returns its exit code, or -1 where a signal ended it.
int live_in_a_process(const std::string& journal, int from, int to, int fatal, bool throws = false) {
  const pid_t child = fork();
  if (child == 0) {
    ::signal(SIGABRT, SIG_DFL);
    LiveOptions options = journalled(journal);
    const std::int64_t fatal_utime = 1'000'000'000 + fatal * std::int64_t{100'000};
    options.log = [&](LogLevel level, std::string_view message, const LogFields&) {
      if (level == LogLevel::error) std::ofstream(journal + "/said", std::ios::app) << message << "\n";
    };
    options.before_event = [&](const Event& event) {
      const auto* scan = std::get_if<ScanEvent>(&event.body);
      if (scan == nullptr || scan->scan.utime != fatal_utime) return;
      if (throws) throw std::logic_error("an invariant is broken");
      ::kill(::getpid(), SIGKILL);
    };
    int code = 1;
    try {
      Inbox inbox;
      LiveServer server(options, inbox, [](const auto&, const auto&) {});
      drive(inbox, from, to);
      inbox.close();
      server.run();
      code = 0;
    } catch (const std::exception&) {
    }
    ::_exit(code);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(AFatalEvent, IsSetAsideAfterItsSecondCrashAndReplayPassesItOverToo) {
  for (const bool throws : {false, true}) {
    TemporaryDirectory directory;
    const std::string journal = directory / "journal";
    const int crashed = throws ? 1 : -1;
    EXPECT_EQ(live_in_a_process(journal, 0, 40, 20, throws), crashed) << "live";
    EXPECT_TRUE(read_set_aside(journal).empty());
    EXPECT_EQ(live_in_a_process(journal, 40, 60, 20, throws), crashed) << "while it recovers";
    EXPECT_TRUE(read_set_aside(journal).empty()) << "a process that died cannot say so";
    EXPECT_EQ(live_in_a_process(journal, 60, 80, 20, throws), 0);
    const SetAsideEvents events = read_set_aside(journal);
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(events.begin()->second.channel, "R1_SCAN");
    EXPECT_EQ(events.begin()->second.robot, "R1");
    EXPECT_NE(content(journal + "/said").find(" of the journal on R1_SCAN is set aside"), std::string::npos);

    const MapCopy map = serve(journalled(journal));
    EXPECT_EQ(map.counters.dropped.at(DropReason::set_aside), 1);
    EXPECT_EQ(map.counters.scans, 79);
    const Replayed replayed = replay_of(journal);
    EXPECT_EQ(replayed.sha256, map_sha256(map));
    EXPECT_EQ(replayed.dropped.at(DropReason::set_aside), 1);
    EXPECT_EQ(live_in_a_process(journal, 80, 90, 20, throws), 0) << "and again";
  }
}

TEST(AFatalEvent, IsNotSetAsideForOneCrash) {
  TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  EXPECT_EQ(live_in_a_process(journal, 0, 40, 20), -1);
  EXPECT_EQ(live_in_a_process(journal, 40, 60, 1000), 0) << "it was not the event's fault";
  EXPECT_EQ(live_in_a_process(journal, 60, 80, 20), -1) << "in recovery, but it was got past before";
  EXPECT_EQ(live_in_a_process(journal, 80, 90, 1000), 0);
  EXPECT_TRUE(read_set_aside(journal).empty());
  expect_each_once(journal, 1 + 2 * 90);
}

}  // namespace
}  // namespace isthmus
