#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/run/simulation.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

/// Of the scenarios that come with Isthmus: their lasers are where their robots say.
constexpr MountSurvey exact_mounts{0, 0};

void print(const std::string& what, const ConfidenceTally& tally) {
  const Confidence c = tally.result();
  std::printf("%-20s %8zu %7.1f %7.1f %7.1f %9.3f %9.3f %9.4f %9.4f\n", what.c_str(), c.pairs,
              100 * c.within_95[0], 100 * c.within_95[1], 100 * c.within_95[2], c.mean_nees, c.median_nees,
              c.mean_error_m, c.mean_error_rad);
  std::fflush(stdout);
}

void add(MapConfidence& sum, const MapConfidence& one) {
  sum.local.add(one.local);
  sum.island.add(one.island);
  sum.undetermined += one.undetermined;
}

MapConfidence run_scenario(const std::string& name, const CampaignRuns& arguments) {
  MapConfidence sum;
  for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    const SimulatedRun run = simulate(arguments.load(name, seed), seed);
    add(sum, judge_confidence(map_events(run.events), run.truth, EngineOptions{}, exact_mounts));
  }
  return sum;
}

void confidence_campaign(const CampaignRuns& arguments) {
  std::printf("%-20s %8s %7s %7s %7s %9s %9s %9s %9s\n", "", "pairs", "x %", "y %", "yaw %", "NEES/dof",
              "median", "error m", "error rad");
  MapConfidence all;
  for (const std::string& name : arguments.scenarios) {
    const MapConfidence one = run_scenario(name, arguments);
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
  for (const auto& scenario : list_scenarios()) {
    if (scenario.name.starts_with("campaign_")) names.push_back(scenario.name);
  }
  return names;
}

}  // namespace

void add_confidence_command(CLI::App& app) {
  const auto arguments = std::make_shared<CampaignRuns>();
  CLI::App* confidence = app.add_subcommand(
      "confidence",
      "Tells how often the truth lies within the 95 % intervals of relative poses, and the normalised\n"
      "estimation error squared (NEES) for each degree of freedom, within local maps and across islands.");
  confidence
      ->add_option("--scenario", arguments->scenarios, "Scenarios to run (default: all named campaign_...)")
      ->allow_extra_args(false);
  arguments->add_runs(*confidence);
  confidence->callback([arguments] {
    if (arguments->scenarios.empty()) arguments->scenarios = campaign_scenarios();
    confidence_campaign(*arguments);
  });
}

}  // namespace isthmus
