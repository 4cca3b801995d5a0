#include "server/program/option_tree.hpp"

#include <CLI/CLI.hpp>

namespace isthmus {
namespace {

bool is_group(const CLI::App* app) { return app->get_name().empty(); }

}  // namespace

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* below) { return !is_group(below); });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  std::vector<const CLI::Option*> options = app.get_options();
  for (const CLI::App* group : app.get_subcommands(is_group)) {
    std::vector<const CLI::Option*> more = options_of(*group);
    std::erase(more, group->get_help_ptr());  // each has its own
    options.insert(options.end(), more.begin(), more.end());
  }
  return options;
}

std::vector<CLI::Option*> all_options_of(CLI::App& app) {
  std::vector<CLI::Option*> options = app.get_options();
  for (CLI::App* below : app.get_subcommands(std::function<bool(CLI::App*)>())) {
    const std::vector<CLI::Option*> more = all_options_of(*below);
    options.insert(options.end(), more.begin(), more.end());
  }
  return options;
}

bool is_shown(const CLI::Option& option) { return !option.get_group().empty(); }

}  // namespace isthmus
