#include "server/program/manual.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace isthmus {
namespace {

struct Program {
  Program() : app("Does a thing.", "isthmus-test") {
    app.add_option("-o,--output", output, ".hidden-looking help");
    app.add_flag("--secret", secret)->group("");
    app.add_subcommand("withdraw", "takes it back")->add_option("--why", output, "a reason");
  }
  CLI::App app;
  std::string output;
  bool secret = false;
};

TEST(Manual, HasOptionsAndCommandsAndNoHiddenOnes) {
  const Program program;
  const std::string page = man_page(program.app, "isthmus-test 1.2 (abc)");
  EXPECT_TRUE(page.starts_with(".TH ISTHMUS-TEST 1 \"\" \"isthmus\\-test 1.2 (abc)\" Isthmus\n")) << page;
  EXPECT_NE(page.find("\\-\\-output"), std::string::npos) << page;
  EXPECT_NE(page.find("\n\\&.hidden\\-looking help\n"), std::string::npos) << "no macro of roff\n" << page;
  EXPECT_NE(page.find(".SS withdraw\ntakes it back\n"), std::string::npos) << page;
  EXPECT_NE(page.find("a reason"), std::string::npos) << page;
  EXPECT_EQ(page.find("secret"), std::string::npos) << page;
}

TEST(Manual, CompletesOptionsAndCommands) {
  const Program program;
  const std::string script = bash_completion(program.app);
  EXPECT_NE(script.find(" --output -o withdraw\""), std::string::npos) << script;
  EXPECT_NE(script.find("withdraw) words+=\""), std::string::npos) << script;
  EXPECT_NE(script.find("complete -o default -F _isthmus_test isthmus-test\n"), std::string::npos) << script;
  EXPECT_EQ(script.find("secret"), std::string::npos) << script;
}

}  // namespace
}  // namespace isthmus
