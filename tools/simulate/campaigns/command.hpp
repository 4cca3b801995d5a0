#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/engine/input/configuration.hpp"
#include "tools/simulate/scenario/scenario.hpp"

namespace CLI {
class App;
}

namespace isthmus {

/// The runs that a campaign asks for.
struct CampaignRuns {
  std::vector<std::string> scenarios;
  std::uint64_t seeds = 100;
  std::uint64_t first_seed = 1;
  bool force = false;                  ///< results that are there already are written over
  std::vector<std::string> overrides;  ///< "{seed}" in them stands for the run's seed: floor.seed={seed}

  /// Throws as load_scenario does.
  Scenario load(const std::string& name, std::uint64_t seed) const;

  /// Options of a subcommand.
  void add_seeds(CLI::App& command);      ///< --seeds, --first-seed
  void add_runs(CLI::App& command);       ///< those and --set
  void add_scenario(CLI::App& command);   ///< one --scenario, required
  void add_scenarios(CLI::App& command);  ///< one or more
};

/// What a campaign maps with.
struct CampaignConfiguration {
  std::string file;  ///< empty: the defaults

  /// Throws as parse_server_configuration does, or where the file cannot be read.
  Configuration load() const;

  /// --config
  void add_to(CLI::App& command);
};

/// Each adds a subcommand that runs its campaign and prints a row for each run as it ends.
/// @{
void add_confidence_command(CLI::App& app);
void add_sightings_command(CLI::App& app);
void add_closures_command(CLI::App& app);
void add_hostile_command(CLI::App& app);
void add_features_command(CLI::App& app);
void add_rendezvous_command(CLI::App& app);
void add_floor_plans_command(CLI::App& app);
void add_paths_command(CLI::App& app);
void add_explore_command(CLI::App& app);
void add_home_command(CLI::App& app);
/// @}

}  // namespace isthmus
