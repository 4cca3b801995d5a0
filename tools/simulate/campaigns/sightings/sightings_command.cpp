#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/sightings/sightings.hpp"

namespace isthmus {
namespace {

struct SightingsArguments : CampaignRuns {
  double false_share = 0.3;
  std::string output;
};

void print(const std::string& what, const SightingTrial& t) {
  std::printf("%-10s %7zu %6zu %7zu %8zu %6zu %6.1f %9.4f %9.4f %9.4f %9.4f %7.3f\n", what.c_str(), t.islands,
              t.clean_islands, t.score.false_ones, t.score.false_accepted, t.score.true_ones,
              100 * t.score.true_share(), t.intra.mean_m, t.intra.mean_clean_m, t.inter.mean_m,
              t.inter.mean_clean_m, t.error_ratio());
  std::fflush(stdout);
}

// Sums of everything but the seed.
SightingTrial sum_of(const std::vector<SightingTrial>& trials) {
  SightingTrial sum;
  for (const SightingTrial& t : trials) {
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

void summarise(const std::vector<SightingTrial>& trials) {
  const SightingTrial sum = sum_of(trials);
  print("all", sum);
  std::size_t whole = 0, spoilt = 0;
  double worst = 0;
  for (const SightingTrial& t : trials) {
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

void sightings_campaign(const SightingsArguments& arguments) {
  check_new_file(arguments.output, arguments.force);
  std::printf("%-10s %7s %6s %7s %8s %6s %6s %9s %9s %9s %9s %7s\n", "seed", "islands", "clean", "false",
              "accepted", "true", "acc. %", "intra m", "clean m", "inter m", "clean m", "ratio");
  std::vector<SightingTrial> trials;
  for (const std::string& name : arguments.scenarios) {
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
      trials.push_back(try_sightings(arguments.load(name, seed), seed, arguments.false_share));
      print(std::to_string(seed), trials.back());
    }
  }
  summarise(trials);
  if (!arguments.output.empty()) write_trials(trials, arguments.output);
}

}  // namespace

void add_sightings_command(CLI::App& app) {
  const auto arguments = std::make_shared<SightingsArguments>();
  CLI::App* sightings = app.add_subcommand(
      "sightings",
      "Maps runs with a share of false sightings and the same runs without: which sightings were accepted, "
      "and\n"
      "what the false ones do to the map; {seed} in --set stands for the run's seed: floor.seed={seed}");
  arguments->add_scenario(*sightings);
  arguments->add_runs(*sightings);
  sightings->add_option("--false", arguments->false_share, "Share of false sightings")
      ->check(number_in(0.0, 0.95))
      ->capture_default_str();
  sightings->add_option("-o,--output", arguments->output, "Table to write, a row for each seed")
      ->type_name("FILE");
  add_force(*sightings, arguments->force);
  sightings->callback([arguments] { sightings_campaign(*arguments); });
}

}  // namespace isthmus
