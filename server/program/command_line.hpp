#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace CLI {
class App;
}

namespace isthmus {

/// Exit codes of every program.
constexpr int exit_failed = 1;  ///< what was asked for could not be done; the reason is on stderr
constexpr int exit_usage = 2;   ///< nobody can tell what was asked for

/// What was asked for cannot be understood, as `run` finds out: exit_usage.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A program's way from its command line to its exit code: --version is added, the arguments are read, and
/// `run` does what they ask for. What `run` throws is printed on stderr; for wrong usage,
/// what was probably meant; for a missing command, which there are.
int run_program(CLI::App& app, int argc, const char* const* argv, const std::function<void()>& run = {});

/// Adds --force, for programs that keep from writing over what is there.
void add_force(CLI::App& app, bool& force);

}  // namespace isthmus
