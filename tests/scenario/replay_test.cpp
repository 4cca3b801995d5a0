// How far isthmus-replay reads a log, and what it tells of it.

#include "tools/replay/replay.hpp"

#include <gtest/gtest.h>

#include "server/wire/journal/event_log.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t start_utime = 7'000'000;

/// Something foreign, then a robot without a laser that drives for ten seconds: 101 odometry poses from
/// start_utime on.
std::string write_drive(const TemporaryDirectory& directory) {
  std::string path = directory / "drive.lcm";
  EventLogWriter log(path);
  log.write({1'000'000, "SOMETHING_ELSE", {1, 2, 3}});
  RobotEvent robot;
  robot.robot = "R1";
  robot.utime = start_utime;
  robot.laser = {{}, 0, 0};
  log.write(encode(Event{start_utime, robot}));
  for (int i = 0; i <= 100; ++i) {
    const std::int64_t utime = start_utime + 100'000 * i;
    log.write(encode(Event{utime, OdometryEvent{"R1", utime, {0.05 * i, 0, 0}}}));
  }
  log.finish();
  return path;
}

ReplayOptions until(double seconds) {
  ReplayOptions options;
  options.until_s = seconds;
  return options;
}

TEST(Replay, ReadsToTheEndUnlessToldOtherwise) {
  const TemporaryDirectory directory;
  const Counters counters = replay(write_drive(directory)).engine.copy().counters;
  EXPECT_EQ(counters.events, 102);
  EXPECT_EQ(counters.last_receive_utime, start_utime + 10'000'000);
}

TEST(Replay, UntilCountsFromTheFirstEventAndFinishesWhatWasRead) {
  const TemporaryDirectory directory;
  const std::string log = write_drive(directory);
  const MapCopy half = replay(log, until(5)).engine.copy();
  EXPECT_EQ(half.counters.events, 52) << "the event at the very time is read";
  EXPECT_EQ(half.counters.last_receive_utime, start_utime + 5'000'000);
  ASSERT_EQ(half.sessions.size(), 1U);
  EXPECT_LE(half.sessions.front().to_utime, start_utime + 5'000'000);
  EXPECT_LT(half.patches.size(), replay(log).engine.copy().patches.size());
  EXPECT_EQ(replay(log, until(0)).engine.copy().counters.events, 2);
  EXPECT_EQ(map_sha256(replay(log, until(1e9)).engine.copy()), map_sha256(replay(log).engine.copy()));
}

TEST(Replay, AForbiddenClosureLeavesTheTimesOfTheLogAsTheyAre) {
  const TemporaryDirectory directory;
  ReplayOptions options = until(5);
  options.forbid = {ClosureId{0}};
  const Counters counters = replay(write_drive(directory), options).engine.copy().counters;
  EXPECT_EQ(counters.first_receive_utime, start_utime);
  EXPECT_EQ(counters.last_receive_utime, start_utime + 5'000'000);
}

}  // namespace
}  // namespace isthmus
