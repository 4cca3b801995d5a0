#include "tools/simulate/campaigns/command.hpp"

#include <CLI/CLI.hpp>
#include <string_view>

#include "server/program/values.hpp"
#include "server/wire/file/text_file.hpp"
#include "server/wire/message/server_configuration.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {

Scenario CampaignRuns::load(const std::string& name, std::uint64_t seed) const {
  constexpr std::string_view mark = "{seed}";
  std::vector<std::string> settings = overrides;
  for (std::string& one : settings) {
    const std::size_t at = one.find(mark);
    if (at != std::string::npos) one.replace(at, mark.size(), std::to_string(seed));
  }
  return load_scenario(name, settings);
}

void CampaignRuns::add_seeds(CLI::App& command) {
  command.add_option("--seeds", seeds, "Runs, of each scenario")
      ->check(integer_from(1))
      ->capture_default_str();
  command.add_option("--first-seed,--from", first_seed, "Seed of the first run")->capture_default_str();
}

void CampaignRuns::add_runs(CLI::App& command) {
  add_seeds(command);
  command
      .add_option("--set", overrides,
                  "Override settings of every scenario, {seed} being the run's seed: floor.seed={seed}")
      ->type_name("KEY=VALUE");
}

void CampaignRuns::add_scenario(CLI::App& command) {
  command.add_option("--scenario", scenarios, "Scenario to run")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::Throw);
}

void CampaignRuns::add_scenarios(CLI::App& command) {
  command.add_option("--scenario", scenarios, "Scenarios to run")->required()->allow_extra_args(false);
}

Configuration CampaignConfiguration::load() const {
  if (file.empty()) return {};
  return parse_server_configuration(read_text_file(file), file).engine;
}

void CampaignConfiguration::add_to(CLI::App& command) {
  command.add_option("--config", file, "TOML configuration to map with; else the defaults");
}

}  // namespace isthmus
