#pragma once

namespace CLI {
class App;
}

namespace isthmus {

/// Adds the subcommand "wild": many seeds, a row for each, and what those that failed have in common.
void add_wild_command(CLI::App& app);

}  // namespace isthmus
