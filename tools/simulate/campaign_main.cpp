#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <map>
#include <stdexcept>
#include <utility>

#include "tools/simulate/closures_campaign.hpp"
#include "tools/simulate/confidence_campaign.hpp"
#include "tools/simulate/features_campaign.hpp"
#include "tools/simulate/hostile_campaign.hpp"
#include "tools/simulate/rendezvous_experiment.hpp"
#include "tools/simulate/scenario_file.hpp"
#include "tools/simulate/sightings_campaign.hpp"
#include "tools/simulate/wild/campaign.hpp"
#include "tools/text/finite_number.hpp"

namespace {

struct Arguments {
  std::vector<std::string> scenarios;
  std::uint64_t seeds = 100;
  std::uint64_t first_seed = 1;
  std::vector<std::string> overrides;
  double false_share = 0.3;
  std::int64_t messages = 1'000'000;
  bool everyone = false;
  std::string output;
  unsigned jobs = 1;
  bool keep_failed = false;
  isthmus::FeatureCampaignOptions features;
};

constexpr const char* seed_mark = "{seed}";

// The overrides with the run's seed in the place of "{seed}", as in floor.seed={seed}.
isthmus::Scenario load(const std::string& name, const Arguments& arguments, std::uint64_t seed) {
  std::vector<std::string> overrides = arguments.overrides;
  for (std::string& one : overrides) {
    const std::size_t at = one.find(seed_mark);
    if (at != std::string::npos) one.replace(at, std::string(seed_mark).size(), std::to_string(seed));
  }
  return isthmus::load_scenario(name, overrides);
}

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
  isthmus::MapConfidence sum;
  for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    const isthmus::SimulatedRun run = isthmus::simulate(load(name, arguments, seed), seed);
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

void print(const std::string& what, const isthmus::SightingTrial& t) {
  std::printf("%-10s %7zu %6zu %7zu %8zu %6zu %6.1f %9.4f %9.4f %9.4f %9.4f %7.3f\n", what.c_str(), t.islands,
              t.clean_islands, t.score.false_ones, t.score.false_accepted, t.score.true_ones,
              100 * t.score.true_share(), t.intra.mean_m, t.intra.mean_clean_m, t.inter.mean_m,
              t.inter.mean_clean_m, t.error_ratio());
  std::fflush(stdout);
}

// Sums of everything but the seed.
isthmus::SightingTrial sum_of(const std::vector<isthmus::SightingTrial>& trials) {
  isthmus::SightingTrial sum;
  for (const isthmus::SightingTrial& t : trials) {
    sum.islands += t.islands;
    sum.clean_islands += t.clean_islands;
    sum.score.false_ones += t.score.false_ones;
    sum.score.false_accepted += t.score.false_accepted;
    sum.score.true_ones += t.score.true_ones;
    sum.score.true_accepted += t.score.true_accepted;
    sum.intra.add(t.intra);
    sum.inter.add(t.inter);
  }
  return sum;
}

void summarise(const std::vector<isthmus::SightingTrial>& trials) {
  const isthmus::SightingTrial sum = sum_of(trials);
  print("all", sum);
  std::size_t whole = 0, spoilt = 0;
  double worst = 0;
  for (const isthmus::SightingTrial& t : trials) {
    whole += t.islands == 1 ? 1U : 0U;
    spoilt += t.score.false_accepted > 0 ? 1U : 0U;
    worst = std::max(worst, t.error_ratio());
  }
  std::printf(
      "%zu runs: %zu on one island; false sightings accepted in %zu of them; error ratio at most %.3f\n"
      "relations not told: intra %zu (clean %zu), inter %zu (clean %zu)\n",
      trials.size(), whole, spoilt, worst, sum.intra.missing, sum.intra.missing_clean, sum.inter.missing,
      sum.inter.missing_clean);
}

void sightings_campaign(const Arguments& arguments) {
  std::printf("%-10s %7s %6s %7s %8s %6s %6s %9s %9s %9s %9s %7s\n", "seed", "islands", "clean", "false",
              "accepted", "true", "acc. %", "intra m", "clean m", "inter m", "clean m", "ratio");
  std::vector<isthmus::SightingTrial> trials;
  for (const std::string& name : arguments.scenarios) {
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
      trials.push_back(isthmus::try_sightings(load(name, arguments, seed), seed, arguments.false_share));
      print(std::to_string(seed), trials.back());
    }
  }
  summarise(trials);
  if (!arguments.output.empty()) isthmus::write_trials(trials, arguments.output);
}

void print(const isthmus::ClosureTrial& t) {
  std::printf("%-10llu %7zu %9zu %9zu %6zu %9zu %7zu %9zu %9.4f\n", static_cast<unsigned long long>(t.seed),
              t.score.islands, t.closures_accepted, t.score.relations, t.score.wrong.size(),
              t.score.wrong_closures, t.score.wrong_merges, t.missing, t.mean_error_m);
  std::fflush(stdout);
}

void print_worst(std::vector<isthmus::ClosureTrial> trials) {
  constexpr std::size_t shown = 5;
  std::ranges::stable_sort(trials, isthmus::is_worse);
  std::size_t spoilt = 0, wrong = 0;
  double error_m = 0;
  for (const isthmus::ClosureTrial& t : trials) {
    const std::size_t of_it = t.score.wrong_closures + t.score.wrong_merges;
    wrong += of_it;
    spoilt += of_it > 0 ? 1U : 0U;
    error_m += t.mean_error_m / static_cast<double>(trials.size());
  }
  std::printf("%zu runs: %zu wrong closures and merges, in %zu of them; mean error %.4f m\n", trials.size(),
              wrong, spoilt, error_m);
  std::printf("worst seeds:");
  for (std::size_t i = 0; i < std::min(shown, trials.size()); ++i)
    std::printf(" %llu (%zu, %.4f m)", static_cast<unsigned long long>(trials[i].seed),
                trials[i].score.wrong_closures + trials[i].score.wrong_merges, trials[i].mean_error_m);
  std::printf("\n");
}

void closures_campaign(const Arguments& arguments) {
  for (const std::string& name : arguments.scenarios) {
    std::printf("%s\n%-10s %7s %9s %9s %6s %9s %7s %9s %9s\n", name.c_str(), "seed", "islands", "accepted",
                "relations", "wrong", "closures", "merges", "not told", "error m");
    std::vector<isthmus::ClosureTrial> trials;
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
      trials.push_back(isthmus::try_closures(load(name, arguments, seed), seed));
      print(trials.back());
    }
    print_worst(std::move(trials));
  }
}

void hostile_campaign(const Arguments& arguments) {
  for (const std::string& name : arguments.scenarios) {
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
      const auto names =
          arguments.everyone ? isthmus::HostileNames::everyone : isthmus::HostileNames::intruder;
      const auto t =
          isthmus::try_hostile_messages(load(name, arguments, seed), seed, arguments.messages, names);
      std::printf(
          "%s, seed %llu: %lld hostile messages, %.1f CPU s, %.0f MB at most; %zu patches of theirs\n",
          name.c_str(), static_cast<unsigned long long>(seed), static_cast<long long>(t.messages), t.cpu_s,
          t.peak_rss_mb, t.hostile_patches);
      for (const auto& [reason, count] : t.dropped)
        std::printf("  %-28s %9lld\n", std::string(word(reason)).c_str(), static_cast<long long>(count));
      std::printf("  the team's error: %.4f m over %zu relations (%.4f m without them), %zu not told (%zu)\n",
                  t.errors.mean_m, t.errors.compared, t.errors.mean_clean_m, t.errors.missing,
                  t.errors.missing_clean);
      std::fflush(stdout);
    }
  }
}

void print(const isthmus::WildTrial& t) {
  const isthmus::WildScore& s = t.score;
  std::printf("%-6llu %7zu %9.4f %8.3f %4s %6zu %7zu %7.1f  %s\n", static_cast<unsigned long long>(t.seed),
              s.islands, s.mean_m, s.max_m,
              !t.finished  ? "none"
              : s.is_off() ? "OFF"
                           : "",
              s.wrong_merges, s.missed_merges, t.cpu_s + t.simulation_cpu_s,
              describe(isthmus::draw_wild(t.seed)).c_str());
  std::fflush(stdout);
}

void summarise(const std::vector<isthmus::WildTrial>& trials) {
  std::size_t off = 0, wrong = 0, missed = 0, none = 0;
  double cpu_s = 0;
  for (const isthmus::WildTrial& t : trials) {
    none += t.finished ? 0U : 1U;
    off += t.score.is_off() ? 1U : 0U;
    wrong += t.score.wrong_merges > 0 ? 1U : 0U;
    missed += t.score.missed_merges > 0 ? 1U : 0U;
    cpu_s += t.cpu_s + t.simulation_cpu_s;
  }
  const auto runs = static_cast<double>(trials.size());
  std::printf(
      "%zu runs: %zu (%.1f %%) with a relation over 1 m off, %zu with wrong merges, %zu with missed ones, "
      "%zu without a map; %.1f CPU s a run\n",
      trials.size(), off, 100 * static_cast<double>(off) / runs, wrong, missed, none, cpu_s / runs);
  std::printf("%-18s %8s %8s\n", "drawn", "failed %", "others %");
  for (const isthmus::WildTraitShare& trait : isthmus::compare_traits(trials))
    std::printf("%-18s %8.0f %8.0f\n", trait.name.c_str(), 100 * trait.of_failed, 100 * trait.of_others);
}

void wild_campaign(const Arguments& arguments) {
  std::printf("%-6s %7s %9s %8s %4s %6s %7s %7s  %s\n", "seed", "islands", "mean m", "max m", "", "wrong",
              "missed", "CPU s", "drawn");
  std::vector<isthmus::WildTrial> trials;
  const std::string kept = arguments.keep_failed ? arguments.output : std::string();
  isthmus::try_seeds(
      arguments.first_seed, arguments.seeds, arguments.jobs,
      [&](std::uint64_t seed) { return isthmus::try_wild(seed, kept); },
      [&](const isthmus::WildTrial& trial) {
        print(trial);
        trials.push_back(trial);
      });
  summarise(trials);
  if (!arguments.output.empty()) isthmus::write_wild_trials(trials, arguments.output + "/wild.csv");
  if (!std::ranges::all_of(trials, &isthmus::WildTrial::finished))
    throw std::runtime_error("not every seed could be mapped");
}

void print(const std::string& what, const isthmus::FeatureColumn& c) {
  std::printf("%-10s %8.3f %8.3f %7.2f %8.3f %7.3f %7.3f %8.1f %8.1f %7.1f\n", what.c_str(), c.position_m,
              c.orientation_deg, c.nees, c.alpha_deg, c.rho_m, c.endpoint_m, c.features, c.endpoints,
              c.cpu_s);
  std::fflush(stdout);
}

/// A run in which a robot is a metre off on average, as after a wrong pairing.
bool is_odd(const isthmus::FeatureTrial& trial) {
  return std::ranges::any_of(trial.columns,
                             [](const auto& column) { return column && column->position_m > 1; });
}

void features_campaign(const Arguments& arguments) {
  std::printf("%-10s %8s %8s %7s %8s %7s %7s %8s %8s %7s\n", "", "pos. m", "ori. deg", "NEES/3", "alpha d.",
              "rho m", "ends m", "features", "ends", "CPU s");
  std::vector<isthmus::FeatureTrial> trials;
  for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    isthmus::Scenario scenario = load(arguments.scenarios.front(), arguments, seed);
    scenario.robots.resize(std::min<std::size_t>(2, scenario.robots.size()));
    trials.push_back(
        isthmus::try_features(isthmus::simulate(scenario, seed), scenario.plan, seed, arguments.features));
    const isthmus::FeatureTrial& trial = trials.back();
    std::printf("seed %llu: met at %.0f s, %zu duplicates%s\n", static_cast<unsigned long long>(seed),
                trial.met_s.value_or(-1), trial.duplicates, is_odd(trial) ? ", odd" : "");
    for (std::size_t k = 0; k < trial.columns.size(); ++k)
      if (trial.columns[k]) print(std::string("  ") + isthmus::feature_column_names[k], *trial.columns[k]);
  }
  std::printf("mean of %zu runs, %zu of them odd\n", trials.size(),
              static_cast<std::size_t>(std::ranges::count_if(trials, is_odd)));
  for (std::size_t k = 0; k < isthmus::feature_column_names.size(); ++k)
    print(isthmus::feature_column_names[k],
          isthmus::mean_of(trials, static_cast<isthmus::FeatureColumnId>(k)));
}

void print(const std::string& what, const isthmus::RendezvousScore& s) {
  std::printf("%-10s %7zu %7zu %7zu %7zu %6zu %9.2f %9.3f %8.2f %8.2f %8.1f\n", what.c_str(), s.corners_1,
              s.corners_2, s.duplicates, s.found, s.wrong, s.before_3_sigma_m, s.after_3_sigma_m,
              s.nees_before, s.nees_after, s.fusion_cpu_ms);
  std::fflush(stdout);
}

void rendezvous_campaign(const Arguments& arguments) {
  std::printf("%-10s %7s %7s %7s %7s %6s %9s %9s %8s %8s %8s\n", "seed", "map 1", "map 2", "twins", "found",
              "wrong", "3 sigma m", "fused m", "NEES/3", "fused", "CPU ms");
  std::vector<isthmus::RendezvousScore> scores;
  for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    scores.push_back(isthmus::judge_fusion(isthmus::run_rendezvous_experiment(seed)));
    print(std::to_string(seed), scores.back());
  }
  print("all", isthmus::mean_of(scores));
}

std::vector<std::string> campaign_scenarios() {
  std::vector<std::string> names;
  for (const auto& scenario : isthmus::list_scenarios()) {
    if (scenario.name.starts_with("campaign_")) names.push_back(scenario.name);
  }
  return names;
}

void add_sightings(CLI::App& app, Arguments& arguments) {
  CLI::App* sightings = app.add_subcommand(
      "sightings",
      "Maps runs with a share of false sightings and the same runs without: which sightings were accepted, "
      "and\n"
      "what the false ones do to the map; {seed} in --set stands for the run's seed: floor.seed={seed}");
  sightings->add_option("--scenario", arguments.scenarios, "Scenario to run")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  sightings->add_option("--seeds", arguments.seeds, "Runs")->capture_default_str();
  sightings->add_option("--from", arguments.first_seed, "Seed of the first run")->capture_default_str();
  sightings->add_option("--false", arguments.false_share, "Share of false sightings")
      ->check(isthmus::finite_number & CLI::Range(0.0, 0.95))
      ->capture_default_str();
  sightings->add_option("--output", arguments.output, "Table to write, a row for each seed")
      ->type_name("FILE");
  sightings->add_option("--set", arguments.overrides, "Override a setting of the scenario")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

void add_closures(CLI::App& app, Arguments& arguments) {
  CLI::App* closures = app.add_subcommand(
      "closures",
      "Maps runs and counts the relations from scans that are wrong by more than 1 m or 20 degrees, the\n"
      "closures they come from, and wrong merges; {seed} in --set stands for the run's seed.");
  closures->add_option("--scenario", arguments.scenarios, "Scenarios to run")
      ->required()
      ->allow_extra_args(false);
  closures->add_option("--seeds", arguments.seeds, "Runs of each scenario")->capture_default_str();
  closures->add_option("--from", arguments.first_seed, "Seed of the first run")->capture_default_str();
  closures->add_option("--set", arguments.overrides, "Override a setting of every scenario")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

void add_hostile(CLI::App& app, Arguments& arguments) {
  CLI::App* hostile = app.add_subcommand(
      "hostile", "Maps runs through a server that hears messages that are spoilt between the team's.");
  hostile->add_option("--scenario", arguments.scenarios, "Scenarios to run")
      ->required()
      ->allow_extra_args(false);
  hostile->add_option("--seeds", arguments.seeds, "Runs of each scenario")->capture_default_str();
  hostile->add_option("--from", arguments.first_seed, "Seed of the first run")->capture_default_str();
  hostile->add_option("--messages", arguments.messages, "Hostile messages in each run")
      ->capture_default_str();
  hostile->add_flag("--everyone", arguments.everyone,
                    "Well-formed ones in the name of every robot, and orders about their closures: their map "
                    "is not to be compared, the server is to live");
}

void add_wild(CLI::App& app, Arguments& arguments) {
  CLI::App* wild = app.add_subcommand(
      "wild",
      "Maps runs in buildings that nobody has seen: building, furniture, people, lasers, wheels, tours and "
      "team\n"
      "are drawn from the seed. Tells which maps have a relation over 1 m off, a wrong merge, a true merge\n"
      "missed, and what the runs that failed have in common.");
  wild->add_option("--seeds", arguments.seeds, "Runs")->check(CLI::PositiveNumber)->capture_default_str();
  wild->add_option("--first-seed", arguments.first_seed, "Seed of the first run")->capture_default_str();
  wild->add_option("--jobs", arguments.jobs, "Runs at a time")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI::Option* output =
      wild->add_option("--output", arguments.output, "Where to write wild.csv, a row for each seed")
          ->type_name("DIR")
          ->check(CLI::ExistingDirectory);
  wild->add_flag("--keep-failed", arguments.keep_failed,
                 "Keep log and truth of each run that failed there too")
      ->needs(output);
}

void add_features(CLI::App& app, Arguments& arguments) {
  CLI::App* features = app.add_subcommand(
      "features",
      "Maps runs of two robots by segments, alone and joined at their first rendezvous: tables 2 and 3 of\n"
      "Benedettelli, Garulli and Giannitrapani (2012), courtyards being a building of that kind.");
  features->add_option("--scenario", arguments.scenarios, "Scenario to run; its first two robots")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  features->add_option("--seeds", arguments.seeds, "Runs")->check(CLI::PositiveNumber)->capture_default_str();
  features->add_option("--from", arguments.first_seed, "Seed of the first run")->capture_default_str();
  features->add_option("--set", arguments.overrides, "Override a setting of the scenario: roughness_m=0")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  features
      ->add_option("--surface-sigma", arguments.features.surface_sigma_m,
                   "How rough robots take walls to be, m")
      ->check(isthmus::finite_number & CLI::Range(0.0, 1.0))
      ->capture_default_str();
  features
      ->add_option("--form", arguments.features.form, "invariant or printed (the EKF as the paper has it)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, isthmus::FilterForm>{
          {"invariant", isthmus::FilterForm::invariant}, {"printed", isthmus::FilterForm::printed}}));
  features->add_option("--pairing", arguments.features.pairing, "joint or nearest")
      ->transform(CLI::CheckedTransformer(std::map<std::string, isthmus::Pairing>{
          {"joint", isthmus::Pairing::joint}, {"nearest", isthmus::Pairing::nearest}}));
}

void add_rendezvous(CLI::App& app, Arguments& arguments) {
  CLI::App* rendezvous = app.add_subcommand("rendezvous",
                                            "Fuses two maps of corners at a rendezvous: the experiment of "
                                            "Zhou and Roumeliotis (2006), 4,800 square metres.");
  rendezvous->add_option("--seeds", arguments.seeds, "Runs")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  rendezvous->add_option("--from", arguments.first_seed, "Seed of the first run")->capture_default_str();
}

void add_confidence(CLI::App& app, Arguments& arguments) {
  app.add_option("--scenario", arguments.scenarios, "Scenarios to run (default: all named campaign_...)")
      ->allow_extra_args(false);
  app.add_option("--seeds", arguments.seeds, "Runs of each scenario")->capture_default_str();
  app.add_option("--first-seed", arguments.first_seed, "Seed of the first run")->capture_default_str();
  app.add_option("--set", arguments.overrides,
                 "Override a setting of every scenario: laser.range_sigma_m=0.01")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{
      "Maps simulated runs and tells how often the truth lies within the 95 % intervals of relative poses, "
      "and the\n"
      "normalised estimation error squared (NEES) for each degree of freedom, within local maps and across "
      "islands."};
  add_confidence(app, arguments);
  add_sightings(app, arguments);
  add_closures(app, arguments);
  add_hostile(app, arguments);
  add_wild(app, arguments);
  add_features(app, arguments);
  add_rendezvous(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    if (app.got_subcommand("sightings")) {
      sightings_campaign(arguments);
    } else if (app.got_subcommand("closures")) {
      closures_campaign(arguments);
    } else if (app.got_subcommand("hostile")) {
      hostile_campaign(arguments);
    } else if (app.got_subcommand("wild")) {
      wild_campaign(arguments);
    } else if (app.got_subcommand("features")) {
      features_campaign(arguments);
    } else if (app.got_subcommand("rendezvous")) {
      rendezvous_campaign(arguments);
    } else {
      if (arguments.scenarios.empty()) arguments.scenarios = campaign_scenarios();
      campaign(arguments);
    }
  } catch (const std::exception& error) {
    std::cerr << "isthmus-campaign: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
