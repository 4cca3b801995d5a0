#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Error;
}  // namespace CLI

namespace isthmus {

/// What is said of a command line that CLI11 refused: in plain words what is wrong with it, what was probably
/// meant, and which commands there are where one is missing.
std::string usage_text(const CLI::App& app, const CLI::Error& error,
                       const std::vector<std::string>& arguments);

/// --help of a program and its commands tells what options take as people would say it.
void use_plain_help(CLI::App& app);

}  // namespace isthmus
