// The commands as a user meets them: exit codes, messages, and no half-written output.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

struct CommandResult {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// Runs isthmus-<arguments> in a directory.
CommandResult isthmus(const TemporaryDirectory& directory, const std::string& arguments) {
  const std::string command = "cd '" + directory / "" + "' && " ISTHMUS_BIN_DIRECTORY "/isthmus-" +
                              arguments + " > stdout.txt 2> stderr.txt < /dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(directory / "stdout.txt"),
          content(directory / "stderr.txt")};
}

std::vector<std::string> files_of(const TemporaryDirectory& directory) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory / "")) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

const std::string odometry_line = "ODOM 0 0 0 0 0 0 1.5 host 1.5\n";

TEST(Commands, HelpFitsAScreenAndAWrongOptionExitsWithTwo) {
  const TemporaryDirectory directory;
  for (const char* command :
       {"import", "import carmen", "import mrclam", "replay", "evaluate", "simulate", "command"}) {
    const CommandResult help = isthmus(directory, std::string(command) + " --help");
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_LE(std::count(help.out.begin(), help.out.end(), '\n'), 25) << command;
  }
  for (const char* program : {"server", "import", "replay", "evaluate", "export", "inspect", "simulate",
                              "campaign", "command", "snapshot"}) {
    EXPECT_EQ(isthmus(directory, std::string(program) + " --nonsense").exit_code, 2) << program;
    const CommandResult version = isthmus(directory, std::string(program) + " --version");
    EXPECT_EQ(version.exit_code, 0) << program;
    EXPECT_EQ(version.out.find("isthmus-" + std::string(program) + " "), 0U) << version.out;
  }
  EXPECT_EQ(isthmus(directory, "evaluate").exit_code, 2);
}

TEST(Commands, ResultsAreNotWrittenOverUnlessForced) {
  const TemporaryDirectory directory;
  const std::string simulate = "simulate --scenario meeting --set duration_s=2 seed_of_nothing=1 -o run.lcm";
  EXPECT_NE(isthmus(directory, simulate).err.find("seed_of_nothing"), std::string::npos);  // both are read
  ASSERT_EQ(isthmus(directory, "simulate --scenario meeting --set duration_s=2 -o run.lcm").exit_code, 0);
  const CommandResult again = isthmus(directory, "simulate --scenario meeting -o run.lcm");
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_EQ(again.err, "isthmus-simulate: run.lcm exists already; --force writes over it\n");
  ASSERT_EQ(isthmus(directory, "replay run.lcm -o map").exit_code, 0);
  const CommandResult map_again = isthmus(directory, "replay run.lcm -o map");
  EXPECT_EQ(map_again.exit_code, 1);
  EXPECT_EQ(map_again.err, "isthmus-replay: map holds a map already; --force writes over it\n");
  EXPECT_EQ(isthmus(directory, "replay run.lcm -o map --force").exit_code, 0);
}

TEST(Commands, AnImportThatFailsNamesFileAndLineAndLeavesNothing) {
  const TemporaryDirectory directory;
  directory.write("r.clf", odometry_line + "ODOM 1 2\n");
  const CommandResult run = isthmus(directory, "import carmen --robot R1=r.clf -o run.lcm");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err, "isthmus-import: r.clf:2: wrong count of fields in ODOM: 3 instead of 10\n");
  EXPECT_EQ(files_of(directory), (std::vector<std::string>{"r.clf", "stderr.txt", "stdout.txt"}));
}

TEST(Commands, BadLinesCanBeSkippedAndAreCounted) {
  const TemporaryDirectory directory;
  directory.write("r.clf", odometry_line + "ODOM 1 2\n" + odometry_line);
  const CommandResult run = isthmus(directory, "import carmen --skip-bad-lines --robot R1=r.clf -o run.lcm");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.out.find("1 bad lines skipped"), std::string::npos) << run.out;
  EXPECT_TRUE(std::filesystem::exists(directory / "run.lcm"));
}

TEST(Commands, AnImportOfAMrclamSetThatFailsNamesFileAndLine) {
  const TemporaryDirectory directory;
  directory.write("set/Barcodes.dat", "1 5\n");
  directory.write("set/Robot1_Odometry.dat", "1 0 0\n");
  directory.write("set/Robot1_Measurement.dat", "# none\n1 5 far 0\n");
  const CommandResult run = isthmus(directory, "import mrclam set -o run.lcm");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err, "isthmus-import: set/Robot1_Measurement.dat:2: 'far' is not a believable number\n");
  EXPECT_FALSE(std::filesystem::exists(directory / "run.lcm"));
}

TEST(Commands, OrdersThatCannotBeAreRefusedAndOthersAreSaid) {
  const TemporaryDirectory directory;
  const std::string command = "command --lcm-url memq:// --wait 0.01 ";
  for (const char* order : {"forbid -3", "withdraw -1", "allow -1", "forbid x", "forbid", "drop", "drop a/b",
                            "allow ''", "explode", ""}) {
    const CommandResult run = isthmus(directory, command + order);
    EXPECT_NE(run.exit_code, 0) << order;
    EXPECT_NE(run.err, "") << order;
    EXPECT_EQ(run.out, "") << order;
  }
  const CommandResult unheard = isthmus(directory, command + "drop r2");
  EXPECT_EQ(unheard.exit_code, 1);
  EXPECT_EQ(unheard.out, "");
  EXPECT_NE(unheard.err.find("no answer within 0.01 s: either no server runs"), std::string::npos)
      << unheard.err;
  const CommandResult drop = isthmus(directory, "command --lcm-url memq:// --wait 0 drop r2");
  EXPECT_EQ(drop.exit_code, 0);
  EXPECT_EQ(drop.out, "sent: drop robot R2\n");
  EXPECT_EQ(drop.err, "");
  EXPECT_EQ(isthmus(directory, "command --lcm-url file:///x refine").exit_code, 1);
}

TEST(Commands, ReplayOfWhatIsNoLogFailsAndWritesNothing) {
  const TemporaryDirectory directory;
  directory.write("no.lcm", "this is no log\n");
  const CommandResult run = isthmus(directory, "replay no.lcm --output map");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err.find("isthmus-replay: no.lcm"), 0U) << run.err;
  EXPECT_FALSE(std::filesystem::exists(directory / "map/report.json"));
}

TEST(Commands, ReplayReportsDamagedBytesWithTheirPlace) {
  const TemporaryDirectory directory;
  directory.write("r.clf", odometry_line + odometry_line);
  ASSERT_EQ(isthmus(directory, "import carmen --robot R1=r.clf -o run.lcm").exit_code, 0);
  std::string log = content(directory / "run.lcm");
  directory.write("run.lcm", log.substr(0, log.size() - 5));
  const CommandResult run = isthmus(directory, "replay run.lcm --output map");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.err.find("damaged bytes passed over"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("map_sha256"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(directory / "map/report.json"));
}

TEST(Commands, ABadConfigurationIsNamedWithItsLine) {
  const TemporaryDirectory directory;
  directory.write("r.clf", odometry_line);
  directory.write("bad.toml", "\nnonsense = 1\n");
  ASSERT_EQ(isthmus(directory, "import carmen --robot R1=r.clf -o run.lcm").exit_code, 0);
  const CommandResult run = isthmus(directory, "replay run.lcm --output map --config bad.toml");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("bad.toml:2"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace isthmus
