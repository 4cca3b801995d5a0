#pragma once

#include <string>

namespace CLI {
class App;
}

namespace isthmus {

/// What --help says, as a page for man(1). `version`: of version_text.
std::string man_page(const CLI::App& app, const std::string& version);

/// A program's commands and options, and the words that options take, for bash's completion (bash(1),
/// "Programmable Completion"); file names where none of them fits.
std::string bash_completion(const CLI::App& app);

}  // namespace isthmus
