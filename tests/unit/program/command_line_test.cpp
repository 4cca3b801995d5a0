#include "server/program/command_line.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <vector>

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
  for (const std::string& command : commands) app.add_subcommand(command, "does " + command);
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

TEST(CommandLine, AnOptionsValueIsNoOption) { EXPECT_EQ(run({"--output=--outptu"}).exit_code, 0); }

TEST(CommandLine, AsksWhichCommandAndSuggestsOne) {
  const Result none = run({}, {"withdraw", "forbid"});
  EXPECT_EQ(none.exit_code, exit_usage);
  EXPECT_NE(none.err.find("  withdraw  does withdraw\n  forbid    does forbid\n"), std::string::npos)
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
