#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/sightings/closures.hpp"

namespace isthmus {
namespace {

void print(const ClosureTrial& t) {
  std::printf("%-10llu %7zu %9zu %9zu %6zu %9zu %7zu %9zu %9.4f\n", static_cast<unsigned long long>(t.seed),
              t.score.islands, t.closures_accepted, t.score.relations, t.score.wrong.size(),
              t.score.wrong_closures, t.score.wrong_merges, t.missing, t.mean_error_m);
  std::fflush(stdout);
}

void print_worst(std::vector<ClosureTrial> trials) {
  constexpr std::size_t shown = 5;
  std::ranges::stable_sort(trials, is_worse);
  std::size_t spoilt = 0, wrong = 0;
  double error_m = 0;
  for (const ClosureTrial& t : trials) {
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

void closures_campaign(const CampaignRuns& arguments) {
  for (const std::string& name : arguments.scenarios) {
    std::printf("%s\n%-10s %7s %9s %9s %6s %9s %7s %9s %9s\n", name.c_str(), "seed", "islands", "accepted",
                "relations", "wrong", "closures", "merges", "not told", "error m");
    std::vector<ClosureTrial> trials;
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
      trials.push_back(try_closures(arguments.load(name, seed), seed));
      print(trials.back());
    }
    print_worst(std::move(trials));
  }
}

}  // namespace

void add_closures_command(CLI::App& app) {
  const auto arguments = std::make_shared<CampaignRuns>();
  CLI::App* closures = app.add_subcommand(
      "closures",
      "Maps runs and counts the relations from scans that are wrong by more than 1 m or 20 degrees, the\n"
      "closures they come from, and wrong merges; {seed} in --set stands for the run's seed.");
  arguments->add_scenarios(*closures);
  arguments->add_runs(*closures);
  closures->callback([arguments] { closures_campaign(*arguments); });
}

}  // namespace isthmus
