#include "server/program/manual.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>

#include "server/program/values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

struct Program {
  Program() : app("Does a thing.", "isthmus-test") {
    app.add_option("-o,--output", output, ".hidden-looking help");
    app.add_flag("--secret", secret)->group("");
    app.add_option("--level", output, "how loud")->check(one_of({"info", "warning"}));
    CLI::App* withdraw = app.add_subcommand("withdraw", "takes it back");
    withdraw->add_option("--why", output, "a reason");
    withdraw->add_option_group("frame", "One of them")
        ->add_option("--island", island, "an island")
        ->check(integer_in(0, 9));
  }
  CLI::App app;
  std::string output;
  int island = 0;
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

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

TEST(Manual, HasOptionsOfGroupsAndHelpOnce) {
  const Program program;
  const std::string page = man_page(program.app, "");
  EXPECT_NE(page.find("\\fB\\-\\-island\\fR \\fIINTEGER (from 0 to 9)\\fR\nan island"), std::string::npos)
      << page;
  EXPECT_NE(page.find("\\fIinfo|warning\\fR"), std::string::npos) << page;
  EXPECT_EQ(count(page, "\\-\\-help"), 1U) << page;
  EXPECT_EQ(page.find("\n.SS \n"), std::string::npos) << "a group is no command\n" << page;
}

/// What bash offers for the last of some words.
std::string completed(const std::string& script, const std::string& words, int last) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "complete.sh")
      << script << "COMP_WORDS=(isthmus-test " << words << ") COMP_CWORD=" << last
      << "\n_isthmus_test\necho ${COMPREPLY[@]}\n";
  std::FILE* bash = ::popen(("bash " + (directory / "complete.sh")).c_str(), "r");
  char line[1000] = {};
  const bool read = bash != nullptr && std::fgets(line, sizeof line, bash) != nullptr;
  return bash != nullptr && ::pclose(bash) == 0 && read ? line : "bash failed";
}

TEST(Manual, CompletesWordsThatAnOptionTakes) {
  const Program program;
  const std::string script = bash_completion(program.app);
  EXPECT_EQ(completed(script, "--level in", 2), "info\n");
  EXPECT_EQ(completed(script, "--level = w", 3), "warning\n");
  EXPECT_EQ(completed(script, "--level =", 2), "info warning\n");
  EXPECT_EQ(completed(script, "withdraw --is", 2), "--island\n");
  EXPECT_EQ(completed(script, "withdraw --hel", 2), "--help\n");
}

TEST(Manual, CompletesOptionsAndCommands) {
  const Program program;
  const std::string script = bash_completion(program.app);
  EXPECT_NE(script.find(" --output -o --level withdraw\""), std::string::npos) << script;
  EXPECT_NE(script.find("withdraw) words+=\""), std::string::npos) << script;
  EXPECT_NE(script.find("complete -o default -F _isthmus_test isthmus-test\n"), std::string::npos) << script;
  EXPECT_EQ(script.find("secret"), std::string::npos) << script;
}

}  // namespace
}  // namespace isthmus
