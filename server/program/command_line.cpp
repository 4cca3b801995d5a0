#include "server/program/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "server/program/manual.hpp"
#include "server/program/spelling.hpp"
#include "server/program/version.hpp"

namespace isthmus {
namespace {

using Arguments = std::vector<std::string>;

/// "--output", "-o": of the program and of the command that was given.
Arguments option_names(const CLI::App& app) {
  Arguments names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  for (const CLI::App* command : app.get_subcommands()) {
    const Arguments more = option_names(*command);
    names.insert(names.end(), more.begin(), more.end());
  }
  return names;
}

/// What is wrong with an argument that looks like an option and is none; empty: nothing.
std::string wrong_option(const CLI::App& app, const Arguments& arguments) {
  const Arguments names = option_names(app);
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    const std::string name = argument.substr(0, argument.find('='));
    if (!name.starts_with("--") || std::ranges::find(names, name) != names.end()) continue;
    return "there is no option " + name + did_you_mean(name, names);
  }
  return "";
}

/// The same of the first word that is nearly a command, where none was given; it may be an option's value
/// that comes first.
std::string wrong_command(const CLI::App& app, const Arguments& arguments) {
  if (!app.get_subcommands().empty()) return "";
  Arguments names;
  for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
  for (const std::string& word : arguments) {
    if (word.starts_with("-")) continue;
    if (const std::string meant = did_you_mean(word, names); !meant.empty())
      return std::string("there is no command '").append(word).append("'").append(meant);
  }
  return "";
}

/// The commands there are, where one should have been given.
std::string list_of_commands(const CLI::App& app) {
  if (commands_of(app).empty() || !app.get_subcommands().empty()) return "";
  std::size_t width = 0;
  for (const CLI::App* command : commands_of(app)) width = std::max(width, command->get_name().size());
  std::string list = "Which of these?\n";
  for (const CLI::App* command : commands_of(app)) {
    std::string name = command->get_name();
    name.resize(width, ' ');
    list += "  " + name + "  " + command->get_description() + "\n";
  }
  return list;
}

int tell_usage(const CLI::App& app, const CLI::ParseError& error, const Arguments& arguments) {
  std::string reason = wrong_option(app, arguments);
  if (reason.empty()) reason = wrong_command(app, arguments);
  if (reason.empty()) reason = error.what();
  std::cerr << app.get_name() + ": " + reason + "\n" + list_of_commands(app) +
                   "Run with --help for more information.\n";
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
  try {
    app.parse(argc, argv);
    if (run) run();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return tell_usage(app, error, Arguments(argv + 1, argv + argc));
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
