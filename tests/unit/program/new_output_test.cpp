#include "server/program/new_output.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

TEST(NewOutput, KeepsAFileThatHoldsSomethingUnlessForced) {
  const TemporaryDirectory directory;
  const std::string file = directory / "run.lcm";
  EXPECT_NO_THROW(check_new_file(file, false));
  std::ofstream(file) << "";
  EXPECT_NO_THROW(check_new_file(file, false));  // nothing is lost
  std::ofstream(file) << "a log";
  EXPECT_THROW(check_new_file(file, false), std::runtime_error);
  EXPECT_NO_THROW(check_new_file(file, true));
  EXPECT_NO_THROW(check_new_file("/dev/null", false));
}

TEST(NewOutput, MakesADirectoryAndLeavesNothingInIt) {
  const TemporaryDirectory directory;
  check_new_directory(directory / "maps/today", false);
  EXPECT_TRUE(std::filesystem::is_directory(directory / "maps/today"));
  EXPECT_TRUE(std::filesystem::is_empty(directory / "maps/today"));
}

TEST(NewOutput, KeepsADirectoryThatHoldsAMapUnlessForced) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "notes.txt") << "no map";
  EXPECT_NO_THROW(check_new_directory(directory / "", false));
  std::ofstream(directory / "report.json") << "{}";
  EXPECT_THROW(check_new_directory(directory / "", false), std::runtime_error);
  EXPECT_NO_THROW(check_new_directory(directory / "", true));
}

TEST(NewOutput, KeepsFilesOfADirectoryThatWouldBeWrittenOver) {
  const TemporaryDirectory directory;
  EXPECT_NO_THROW(check_new_files_in(directory / "missing", {".png"}, false));
  std::ofstream(directory / "notes.txt") << "no picture";
  EXPECT_NO_THROW(check_new_files_in(directory / "", {".png"}, false));
  std::ofstream(directory / "run.png") << "a picture";
  EXPECT_THROW(check_new_files_in(directory / "", {".csv", ".png"}, false), std::runtime_error);
  EXPECT_THROW(check_new_files_in(directory / "", {"un.png"}, false), std::runtime_error);
  EXPECT_NO_THROW(check_new_files_in(directory / "", {"an.png"}, false));
  EXPECT_NO_THROW(check_new_files_in(directory / "", {".csv", ".png"}, true));
}

TEST(NewOutput, TellsWhereNothingCanBeWritten) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "plain") << "a file";
  EXPECT_THROW(check_new_directory(directory / "plain/map", true), std::runtime_error);
  if (::geteuid() != 0) GTEST_SKIP() << "/proc is tried as root only";
  EXPECT_THROW(check_new_directory("/proc", true), std::runtime_error);
}

}  // namespace
}  // namespace isthmus
