#pragma once

#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace isthmus {

/// A program's commands, hidden ones too; none: it has no commands. CLI11 keeps groups of options among them.
std::vector<const CLI::App*> commands_of(const CLI::App& app);

/// The options of a program or command, those of its groups among them, but not of its commands.
std::vector<const CLI::Option*> options_of(const CLI::App& app);

/// The options of a program or command and of all that is below it.
std::vector<CLI::Option*> all_options_of(CLI::App& app);

/// Whether --help tells of an option.
bool is_shown(const CLI::Option& option);

}  // namespace isthmus
