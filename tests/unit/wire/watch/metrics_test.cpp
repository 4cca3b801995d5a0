#include "server/wire/watch/metrics.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <thread>

#include "server/wire/watch/log_line.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/published.hpp"
#include "tests/support/waiting.hpp"

namespace isthmus {
namespace {

bool has_line(const std::string& text, const std::string& wanted) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line == wanted) return true;
  }
  return false;
}

TEST(Metrics, AreTheCountersOfTheStatus) {
  status_t status{};
  status.events = 12;
  status.closures_waiting = 3;
  status.dropped.resize(1);
  status.dropped[0].reason = "forged";
  status.dropped[0].count = 7;
  robot_status_t robot{};
  robot.robot = "R1";
  robot.last_heard_utime = 1'500'000;
  robot.share_matched = 0.25;
  status.robots.push_back(robot);
  warning_t warning{};
  warning.kind = "clock_ahead";
  warning.robot = "R1";
  status.warnings.push_back(warning);
  const std::string text = metrics_text(status);
  for (const std::string line :
       {"# TYPE isthmus_events_total counter", "isthmus_events_total 12",
        "isthmus_closures{state=\"waiting\"} 3", "isthmus_dropped_total{reason=\"forged\"} 7",
        "isthmus_robot_last_heard_seconds{robot=\"R1\"} 1.5",
        "isthmus_robot_share_matched{robot=\"R1\"} 0.25",
        "isthmus_warning{kind=\"clock_ahead\",robot=\"R1\"} 1"})
    EXPECT_TRUE(has_line(text, line)) << line << "\n" << text;
}

TEST(Metrics, ComeFromALiveServer) {
  LiveOptions options = quick_options();
  std::mutex mutex;
  std::string latest;
  options.metrics = [&](std::string text) {
    const std::lock_guard lock(mutex);
    latest = std::move(text);
  };
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  std::thread engine([&] { server.run(); });
  const auto introduction = BoxRoomRobot("R1").introduction();
  inbox.push("R1", false, introduction.utime, introduction.channel, introduction.bytes);
  const auto told = [&] {
    const std::lock_guard lock(mutex);
    return has_line(latest, "isthmus_events_total 2");
  };
  EXPECT_TRUE(happens(told)) << latest;
  inbox.close();
  engine.join();
}

TEST(LogLine, IsOneLineWhateverCameOverTheWire) {
  EXPECT_EQ(log_line(1'700'000'000'123'456, LogLevel::warning, "a robot",
                     {{"name", "R1"}, {"text", "x\n\"y\" z=1"}, {"none", ""}}),
            "time=2023-11-14T22:13:20.123Z level=warning msg=\"a robot\" name=R1 "
            "text=\"x \\\"y\\\" z=1\" none=\"\"");
}

TEST(LogLine, KnowsItsLevels) {
  EXPECT_EQ(parse_log_level("error"), LogLevel::error);
  EXPECT_FALSE(parse_log_level("loud"));
}

TEST(ClosureLog, TellsEachVerdictOnce) {
  std::string told;
  const Log log = [&](LogLevel level, std::string_view message, const LogFields& fields) {
    told += log_line(0, level, message, fields).substr(std::string("time=1970-01-01T00:00:00.000Z ").size()) +
            "\n";
  };
  ClosureLog closures;
  ClosureRecord merge;
  merge.id = {4};
  merge.kind = ClosureKind::merge;
  merge.state = ClosureState::waiting;
  merge.robots = {"R1", "R2"};
  closures.tell({merge}, log);
  EXPECT_EQ(told, "");
  merge.state = ClosureState::accepted;
  closures.tell({merge}, log);
  closures.tell({merge}, log);
  EXPECT_EQ(told, "level=info msg=\"merge accepted\" closure=4 reason=\"\" robots=R1,R2 patches=0\n");
}

TEST(ClosureLog, TellsHowManyRelationsAClosureTookOutAsWrong) {
  std::string told;
  ClosureRecord loop;
  loop.state = ClosureState::accepted;
  loop.account.blamed = 3;
  ClosureLog().tell({loop}, [&](LogLevel level, std::string_view message, const LogFields& fields) {
    told = log_line(0, level, message, fields);
  });
  EXPECT_NE(told.find(" blamed_relations=3"), std::string::npos) << told;
}

}  // namespace
}  // namespace isthmus
