#include "server/program/command_line.hpp"

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "server/program/manual.hpp"
#include "server/program/usage.hpp"
#include "server/program/values.hpp"
#include "server/program/version.hpp"

namespace isthmus {
namespace {

int tell_usage(const CLI::App& app, const std::string& text) {
  std::cerr << app.get_name() + ": " + text + "Run with --help for more information.\n";
  return exit_usage;
}

}  // namespace

int run_program(CLI::App& app, int argc, const char* const* argv, const std::function<void()>& run) {
  const std::string version = version_text(app.get_name());
  app.set_version_flag("--version", version, "print the version and its commit");
  // For who installs them; no group: --help does not tell of them.
  app.add_flag_callback("--man", [&] { throw CLI::CallForVersion(man_page(app, version), 0); })->group("");
  app.add_flag_callback("--bash-completion", [&] { throw CLI::CallForVersion(bash_completion(app), 0); })
      ->group("");
  check_types(app);
  use_plain_help(app);
  try {
    app.parse(argc, argv);
    if (run) run();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return tell_usage(app, usage_text(app, error, std::vector<std::string>(argv + 1, argv + argc)));
  } catch (const UsageError& error) {
    return tell_usage(app, std::string(error.what()) + "\n");
  } catch (const std::exception& error) {
    std::cerr << app.get_name() + ": " + error.what() + "\n";
    return exit_failed;
  }
  return 0;
}

void add_force(CLI::App& app, bool& force) {
  app.add_flag("--force", force, "write over results that are there already");
}

}  // namespace isthmus
