#include "server/program/command_line.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <vector>

#include "server/program/values.hpp"

namespace isthmus {
namespace {

struct Result {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// A program with an option, and with commands where there are any.
Result run(const std::vector<std::string>& arguments, const std::vector<std::string>& commands = {},
           const std::function<void()>& action = {}) {
  CLI::App app("A program.", "isthmus-test");
  std::string output;
  app.add_option("-o,--output", output, "a file");
  int island = 0, patch = 0;
  double speed = 0;
  for (const std::string& command : commands) {
    CLI::App* one = app.add_subcommand(command, "does " + command + "\nand more");
    one->add_option("--speed", speed, "how fast")->check(number_in(0.01, 100));
    CLI::Option_group* frame = one->add_option_group("frame", "One of them");
    frame->require_option(1);
    frame->add_option("--island", island, "an island");
    frame->add_option("--patch", patch, "a patch");
  }
  if (!commands.empty()) app.require_subcommand(1);
  std::vector<const char*> argv(arguments.size() + 1, "isthmus-test");
  for (std::size_t i = 0; i < arguments.size(); ++i) argv[i + 1] = arguments[i].c_str();
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_program(app, static_cast<int>(argv.size()), argv.data(), action);
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

TEST(CommandLine, TellsItsVersion) {
  const Result result = run({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.out.starts_with("isthmus-test 0.")) << result.out;
}

TEST(CommandLine, SuggestsTheOptionThatWasMeant) {
  const Result result = run({"--outptu", "map"});
  EXPECT_EQ(result.exit_code, exit_usage);
  EXPECT_TRUE(result.err.starts_with("isthmus-test: there is no option --outptu; did you mean '--output'?"))
      << result.err;
}

TEST(CommandLine, KnowsOptionsOfGroups) {
  const auto reason = [](const std::vector<std::string>& arguments) {
    const Result result = run(arguments, {"zone"});
    EXPECT_EQ(result.exit_code, exit_usage);
    return result.err.substr(0, result.err.find('\n'));
  };
  EXPECT_EQ(reason({"zone", "--island", "0", "--speed", "0"}),
            "isthmus-test: --speed: '0' is not a number from 0.01 to 100");
  EXPECT_EQ(reason({"zone", "--ilsand", "0"}),
            "isthmus-test: there is no option --ilsand; did you mean '--island'?");
  EXPECT_EQ(reason({"zone", "--island", "x"}), "isthmus-test: --island: 'x' is not an integer");
  EXPECT_EQ(reason({"zone", "--island", "0", "--patch", "1"}),
            "isthmus-test: --island or --patch is needed, and only one");
  EXPECT_EQ(reason({"zone", "--island"}), "isthmus-test: --island needs a value");
}

TEST(CommandLine, HelpTellsWhatOptionsTakeAsPeopleSayIt) {
  const Result result = run({"zone", "--help"}, {"zone"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("--speed NUMBER (from 0.01 to 100)"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\nOne of them:\n  --island INTEGER"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("FLOAT"), std::string::npos) << result.out;
}

TEST(CommandLine, UsageThatOnlyTheProgramKnowsToBeWrong) {
  const Result result = run({}, {}, [] { throw UsageError("laps must be an integer"); });
  EXPECT_EQ(result.exit_code, exit_usage);
  EXPECT_TRUE(result.err.starts_with("isthmus-test: laps must be an integer\n")) << result.err;
}

TEST(CommandLine, AnOptionsValueIsNoOption) { EXPECT_EQ(run({"--output=--outptu"}).exit_code, 0); }

TEST(CommandLine, AsksWhichCommandAndSuggestsOne) {
  const Result none = run({}, {"withdraw", "forbid"});
  EXPECT_EQ(none.exit_code, exit_usage);
  EXPECT_NE(none.err.find("  withdraw  does withdraw\n            and more\n  forbid    does forbid\n"),
            std::string::npos)
      << none.err;
  const Result wrong = run({"withdrw"}, {"withdraw", "forbid"});
  EXPECT_EQ(wrong.exit_code, exit_usage);
  EXPECT_NE(wrong.err.find("there is no command 'withdrw'; did you mean 'withdraw'?"), std::string::npos)
      << wrong.err;
  const Result later = run({"--output", "udpm://", "withdrw", "3"}, {"withdraw", "forbid"});
  EXPECT_NE(later.err.find("did you mean 'withdraw'?"), std::string::npos) << later.err;
}

TEST(CommandLine, FailsWithTheReason) {
  const Result result = run({}, {}, [] { throw std::runtime_error("run.lcm: no such file"); });
  EXPECT_EQ(result.exit_code, exit_failed);
  EXPECT_EQ(result.err, "isthmus-test: run.lcm: no such file\n");
}

TEST(CommandLine, DoesNothingWhereItIsOnlyAsked) {
  bool done = false;
  EXPECT_EQ(run({"--help"}, {}, [&] { done = true; }).exit_code, 0);
  EXPECT_FALSE(done);
}

}  // namespace
}  // namespace isthmus
