#pragma once

namespace CLI {
class App;
}

namespace isthmus {

/// Adds the subcommand that maps runs and writes what was known of each closure beside whether it is true.
void add_evidence_command(CLI::App& app);

}  // namespace isthmus
