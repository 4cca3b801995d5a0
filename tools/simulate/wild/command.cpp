#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/wild/campaign.hpp"
#include "tools/simulate/wild/command.hpp"

namespace isthmus {
namespace {

struct WildArguments {
  std::uint64_t seeds = 100;
  std::uint64_t first_seed = 1;
  unsigned jobs = 1;
  bool campus = false;
  CampaignConfiguration configuration;
  std::string output;
  bool keep_failed = false;
  bool force = false;
};

void print(const WildTrial& t) {
  const WildScore& s = t.score;
  std::printf("%-6llu %7zu %9.4f %8.3f %4s %6zu %7zu %7.2f %7.2f %7.1f  %s\n",
              static_cast<unsigned long long>(t.seed), s.islands, s.mean_m, s.max_m,
              !t.finished  ? "none"
              : s.is_off() ? "OFF"
                           : "",
              s.wrong_merges, s.missed_merges, t.local_map.mean_nees, t.island.mean_nees,
              t.cpu_s + t.simulation_cpu_s, describe(t.draw()).c_str());
  std::fflush(stdout);
}

// Of all pairs, which a torn run can spoil alone, and of the run in the middle.
void print_confidence(const char* what, const std::vector<WildTrial>& trials, Confidence WildTrial::*which) {
  std::vector<double> nees;
  std::array<double, 3> within{};
  double pairs = 0, sum = 0;
  for (const WildTrial& trial : trials) {
    const Confidence& confidence = trial.*which;
    if (confidence.pairs == 0) continue;
    nees.push_back(confidence.mean_nees);
    const auto weight = static_cast<double>(confidence.pairs);
    for (std::size_t i = 0; i < 3; ++i) within[i] += weight * confidence.within_95[i];
    sum += weight * confidence.mean_nees;
    pairs += weight;
  }
  if (nees.empty()) return;
  std::ranges::sort(nees);
  std::printf("%-10s NEES/dof %.2f, of the middle run %.2f; within 95 %%: x %.1f, y %.1f, yaw %.1f %%\n",
              what, sum / pairs, nees[nees.size() / 2], 100 * within[0] / pairs, 100 * within[1] / pairs,
              100 * within[2] / pairs);
}

void summarise(const std::vector<WildTrial>& trials) {
  std::size_t off = 0, wrong = 0, missed = 0, none = 0;
  double cpu_s = 0;
  for (const WildTrial& t : trials) {
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
  print_confidence("local map", trials, &WildTrial::local_map);
  print_confidence("island", trials, &WildTrial::island);
  std::printf("%-18s %8s %8s\n", "drawn", "failed %", "others %");
  for (const WildTraitShare& trait : compare_traits(trials))
    std::printf("%-18s %8.0f %8.0f\n", trait.name.c_str(), 100 * trait.of_failed, 100 * trait.of_others);
}

void wild_campaign(const WildArguments& arguments) {
  const Configuration configuration = arguments.configuration.load();
  const WildPlace place = arguments.campus ? WildPlace::campus : WildPlace::building;
  if (!arguments.output.empty()) {
    check_new_file(arguments.output + "/wild.csv", arguments.force);
    std::filesystem::create_directories(arguments.output);
  }
  std::printf("%-6s %7s %9s %8s %4s %6s %7s %7s %7s %7s  %s\n", "seed", "islands", "mean m", "max m", "",
              "wrong", "missed", "NEES", "island", "CPU s", "drawn");
  std::vector<WildTrial> trials;
  const std::string kept = arguments.keep_failed ? arguments.output : std::string();
  try_seeds(
      arguments.first_seed, arguments.seeds, arguments.jobs,
      [&](std::uint64_t seed) { return try_wild(seed, kept, configuration, place); },
      [&](const WildTrial& trial) {
        trials.push_back(trial);
        trials.back().place = place;  // also of one that has no map
        print(trials.back());
      });
  summarise(trials);
  if (!arguments.output.empty()) write_wild_trials(trials, arguments.output + "/wild.csv");
  if (!std::ranges::all_of(trials, &WildTrial::finished))
    throw std::runtime_error("not every seed could be mapped");
}

}  // namespace

void add_wild_command(CLI::App& app) {
  const auto arguments = std::make_shared<WildArguments>();
  CLI::App* wild = app.add_subcommand(
      "wild",
      "Maps runs in buildings that nobody has seen: building, furniture, people, lasers, wheels, tours and "
      "team\n"
      "are drawn from the seed. Tells which maps have a relation over 1 m off, a wrong merge, a true merge\n"
      "missed, and what the runs that failed have in common.");
  wild->add_option("--seeds", arguments->seeds, "Runs")->check(integer_from(1))->capture_default_str();
  wild->add_option("--first-seed,--from", arguments->first_seed, "Seed of the first run")
      ->capture_default_str();
  wild->add_option("--jobs", arguments->jobs, "Runs at a time")
      ->check(integer_from(1))
      ->capture_default_str();
  wild->add_flag("--campus", arguments->campus,
                 "Campuses instead: streets of 8 to 28 m between houses, lasers that see 25 to 80 m");
  arguments->configuration.add_to(*wild);
  CLI::Option* output =
      wild->add_option("-o,--output", arguments->output, "Where to write wild.csv, a row for each seed")
          ->type_name("DIR");
  wild->add_flag("--keep-failed", arguments->keep_failed,
                 "Keep log and truth of each run that failed there too")
      ->needs(output);
  add_force(*wild, arguments->force);
  wild->callback([arguments] { wild_campaign(*arguments); });
}

}  // namespace isthmus
