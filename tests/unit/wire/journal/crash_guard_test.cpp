#include "server/wire/journal/recovery/crash_guard.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "server/wire/journal/set_aside.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

/// A process that takes events [0, 10) and ends inside `end`.
void live_until(const std::string& directory, std::int64_t end) {
  CrashGuard guard(directory);
  for (std::int64_t i = 0; i < end; ++i) {
    guard.enter(i);
    guard.leave();
  }
  guard.enter(end);
}

TEST(CrashGuard, CondemnsAnEventInsideWhichTheProcessEndedTwiceRunning) {
  TemporaryDirectory directory;
  live_until(directory / "", 7);
  EXPECT_FALSE(CrashGuard(directory / "").is_condemned(7)) << "once";
  live_until(directory / "", 7);
  EXPECT_TRUE(CrashGuard(directory / "").is_condemned(7));
  EXPECT_TRUE(CrashGuard(directory / "").is_condemned(7)) << "until it was set aside";
  EXPECT_FALSE(CrashGuard(directory / "").is_condemned(6));
  live_until(directory / "", 6);
  live_until(directory / "", 7);
  live_until(directory / "", 7);
  EXPECT_TRUE(CrashGuard(directory / "").is_condemned(7)) << "after an end inside another";
}

TEST(CrashGuard, ForgetsAnEventThatWasGotPast) {
  TemporaryDirectory directory;
  live_until(directory / "", 7);
  live_until(directory / "", 9);
  live_until(directory / "", 7);
  EXPECT_FALSE(CrashGuard(directory / "").is_condemned(7));
  EXPECT_EQ(CrashGuard(directory / "").suspect(), 7);
  EXPECT_EQ(CrashGuard(directory / "").ends(), 1);
}

TEST(CrashGuard, SuspectsNothingOfAProcessThatEndedBetweenEvents) {
  TemporaryDirectory directory;
  for (int i = 0; i < 3; ++i) {
    CrashGuard guard(directory / "");
    EXPECT_EQ(guard.suspect(), -1);
    guard.enter(5);
    guard.leave();
  }
}

TEST(CrashGuard, TakesAFileThatIsTooShortForOneThatSaysNothing) {
  TemporaryDirectory directory;
  directory.write("crash-guard", "");
  EXPECT_EQ(CrashGuard(directory / "").suspect(), -1);
}

TEST(CrashGuard, NamesTheFileThatItCannotWrite) {
  TemporaryDirectory directory;
  std::filesystem::create_directory(directory / "crash-guard");
  EXPECT_EQ(error_of([&] { CrashGuard guard(directory / ""); }),
            directory / "crash-guard" + ": Is a directory");
}

TEST(SetAside, ReadsBackWhatItWrote) {
  TemporaryDirectory directory;
  EXPECT_TRUE(read_set_aside(directory / "").empty());
  const SetAsideEvents events = {{3, {1'000'000, "R1", "R1_SCAN", "crashed twice"}},
                                 {12, {-5, "", "lasers, \"front\"", "x"}}};
  write_set_aside(directory / "", events);
  const SetAsideEvents read = read_set_aside(directory / "");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read.at(3).robot, "R1");
  EXPECT_EQ(read.at(3).utime, 1'000'000);
  EXPECT_EQ(read.at(12).channel, "lasers, \"front\"");
}

TEST(SetAside, NamesTheLineThatIsWrong) {
  TemporaryDirectory directory;
  directory.write("set-aside.csv",
                  "sequence,receive_utime,robot,channel,reason\n1,2,R1,R1_SCAN,x\nx,2,R1,R1_SCAN,x\n");
  EXPECT_EQ(error_of([&] { read_set_aside(directory / ""); }),
            directory / "set-aside.csv" + ":3: sequence and receive_utime must be integers");
  directory.write("set-aside.csv", "sequence\n");
  EXPECT_NE(error_of([&] { read_set_aside(directory / ""); }).find("set-aside.csv:1: must be"),
            std::string::npos);
}

}  // namespace
}  // namespace isthmus
