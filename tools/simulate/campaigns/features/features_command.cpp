#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/program/values.hpp"
#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/features/features.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {
namespace {

struct FeaturesArguments : CampaignRuns {
  FeatureCampaignOptions features;
};

void print(const std::string& what, const FeatureColumn& c) {
  std::printf("%-10s %8.3f %8.3f %7.2f %8.3f %7.3f %7.3f %7.3f %8.1f %8.1f %7.1f\n", what.c_str(),
              c.position_m, c.orientation_deg, c.nees, c.alpha_deg, c.rho_m, c.middle_m, c.endpoint_m,
              c.features, c.endpoints, c.cpu_s);
  std::fflush(stdout);
}

/// A run in which a robot is a metre off on average, as after a wrong pairing.
bool is_odd(const FeatureTrial& trial) {
  return std::ranges::any_of(trial.columns,
                             [](const auto& column) { return column && column->position_m > 1; });
}

void features_campaign(const FeaturesArguments& arguments) {
  std::printf("%-10s %8s %8s %7s %8s %7s %7s %7s %8s %8s %7s\n", "", "pos. m", "ori. deg", "NEES/3",
              "alpha d.", "rho m", "mid m", "ends m", "features", "ends", "CPU s");
  std::vector<FeatureTrial> trials;
  for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    Scenario scenario = arguments.load(arguments.scenarios.front(), seed);
    scenario.robots.resize(std::min<std::size_t>(2, scenario.robots.size()));
    trials.push_back(try_features(simulate(scenario, seed), scenario.plan, seed, arguments.features));
    const FeatureTrial& trial = trials.back();
    std::printf("seed %llu: met at %.0f s, %zu duplicates%s\n", static_cast<unsigned long long>(seed),
                trial.met_s.value_or(-1), trial.duplicates, is_odd(trial) ? ", odd" : "");
    for (std::size_t k = 0; k < trial.columns.size(); ++k)
      if (trial.columns[k]) print(std::string("  ") + feature_column_names[k], *trial.columns[k]);
  }
  std::printf("mean of %zu runs, %zu of them odd\n", trials.size(),
              static_cast<std::size_t>(std::ranges::count_if(trials, is_odd)));
  for (std::size_t k = 0; k < feature_column_names.size(); ++k)
    print(feature_column_names[k], mean_of(trials, static_cast<FeatureColumnId>(k)));
}

}  // namespace

void add_features_command(CLI::App& app) {
  const auto arguments = std::make_shared<FeaturesArguments>();
  CLI::App* features = app.add_subcommand(
      "features",
      "Maps runs of two robots by segments, alone and joined at their first rendezvous: tables 2 and 3 of\n"
      "Benedettelli, Garulli and Giannitrapani (2012), courtyards being a building of that kind.");
  arguments->add_scenario(*features);
  arguments->add_runs(*features);
  features
      ->add_option("--surface-sigma", arguments->features.surface_sigma_m,
                   "How rough robots take walls to be, m")
      ->check(number_in(0.0, 1.0))
      ->capture_default_str();
  features
      ->add_option("--form", arguments->features.form, "invariant or printed (the EKF as the paper has it)")
      ->transform(one_of(std::map<std::string, FilterForm>{{"invariant", FilterForm::invariant},
                                                           {"printed", FilterForm::printed}}));
  features->add_option("--pairing", arguments->features.pairing, "joint or nearest")
      ->transform(
          one_of(std::map<std::string, Pairing>{{"joint", Pairing::joint}, {"nearest", Pairing::nearest}}));
  features->callback([arguments] { features_campaign(*arguments); });
}

}  // namespace isthmus
