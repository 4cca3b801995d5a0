#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>

#include "tools/simulate/confidence_campaign.hpp"
#include "tools/simulate/scenario_file.hpp"

namespace {

struct Arguments {
  std::vector<std::string> scenarios;
  std::uint64_t seeds = 100;
  std::uint64_t first_seed = 1;
  std::vector<std::string> overrides;
};

void print(const std::string& what, const isthmus::ConfidenceTally& tally) {
  const isthmus::Confidence c = tally.result();
  std::printf("%-20s %8zu %7.1f %7.1f %7.1f %9.3f %9.3f %9.4f %9.4f\n", what.c_str(), c.pairs,
              100 * c.within_95[0], 100 * c.within_95[1], 100 * c.within_95[2], c.mean_nees, c.median_nees,
              c.mean_error_m, c.mean_error_rad);
  std::fflush(stdout);
}

void add(isthmus::MapConfidence& sum, const isthmus::MapConfidence& one) {
  sum.local.add(one.local);
  sum.island.add(one.island);
  sum.undetermined += one.undetermined;
}

isthmus::MapConfidence run_scenario(const std::string& name, const Arguments& arguments) {
  const isthmus::Scenario scenario = isthmus::load_scenario(name, arguments.overrides);
  isthmus::MapConfidence sum;
  for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    const isthmus::SimulatedRun run = isthmus::simulate(scenario, seed);
    add(sum, isthmus::judge_confidence(isthmus::map_events(run.events), run.truth, isthmus::EngineOptions{}));
  }
  return sum;
}

void campaign(const Arguments& arguments) {
  std::printf("%-20s %8s %7s %7s %7s %9s %9s %9s %9s\n", "", "pairs", "x %", "y %", "yaw %", "NEES/dof",
              "median", "error m", "error rad");
  isthmus::MapConfidence all;
  for (const std::string& name : arguments.scenarios) {
    const isthmus::MapConfidence one = run_scenario(name, arguments);
    std::printf("%s\n", name.c_str());
    print("  local map", one.local);
    print("  island", one.island);
    add(all, one);
  }
  print("all, local map", all.local);
  print("all, island", all.island);
  if (all.undetermined > 0) std::printf("%zu patches without covariances\n", all.undetermined);
}

std::vector<std::string> campaign_scenarios() {
  std::vector<std::string> names;
  for (const auto& scenario : isthmus::list_scenarios()) {
    if (scenario.name.starts_with("campaign_")) names.push_back(scenario.name);
  }
  return names;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{
      "Maps simulated runs and tells how often the truth lies within the 95 % intervals of relative poses, "
      "and the\n"
      "normalised estimation error squared (NEES) for each degree of freedom, within local maps and across "
      "islands."};
  app.add_option("--scenario", arguments.scenarios, "Scenarios to run (default: all named campaign_...)")
      ->allow_extra_args(false);
  app.add_option("--seeds", arguments.seeds, "Runs of each scenario")->capture_default_str();
  app.add_option("--first-seed", arguments.first_seed, "Seed of the first run")->capture_default_str();
  app.add_option("--set", arguments.overrides,
                 "Override a setting of every scenario: laser.range_sigma_m=0.01")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  CLI11_PARSE(app, argc, argv);
  try {
    if (arguments.scenarios.empty()) arguments.scenarios = campaign_scenarios();
    campaign(arguments);
  } catch (const std::exception& error) {
    std::cerr << "isthmus-campaign: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
