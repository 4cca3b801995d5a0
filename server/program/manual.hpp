#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace isthmus {

/// A program's commands, hidden ones too; none: it has no commands.
std::vector<const CLI::App*> commands_of(const CLI::App& app);

/// What --help says, as a page for man(1). `version`: of version_text.
std::string man_page(const CLI::App& app, const std::string& version);

/// A program's commands and options for bash's completion (bash(1), "Programmable Completion"); file names
/// where none of them fits.
std::string bash_completion(const CLI::App& app);

}  // namespace isthmus
