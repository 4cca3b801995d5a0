#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/features/rendezvous_experiment.hpp"

namespace isthmus {
namespace {

void print(const std::string& what, const RendezvousScore& s) {
  std::printf("%-10s %7zu %7zu %7zu %7zu %6zu %9.2f %9.3f %8.2f %8.2f %8.1f\n", what.c_str(), s.corners_1,
              s.corners_2, s.duplicates, s.found, s.wrong, s.before_3_sigma_m, s.after_3_sigma_m,
              s.nees_before, s.nees_after, s.fusion_cpu_ms);
  std::fflush(stdout);
}

void rendezvous_campaign(const CampaignRuns& arguments) {
  std::printf("%-10s %7s %7s %7s %7s %6s %9s %9s %8s %8s %8s\n", "seed", "map 1", "map 2", "twins", "found",
              "wrong", "3 sigma m", "fused m", "NEES/3", "fused", "CPU ms");
  std::vector<RendezvousScore> scores;
  for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    scores.push_back(judge_fusion(run_rendezvous_experiment(seed)));
    print(std::to_string(seed), scores.back());
  }
  print("all", mean_of(scores));
}

}  // namespace

void add_rendezvous_command(CLI::App& app) {
  const auto arguments = std::make_shared<CampaignRuns>();
  CLI::App* rendezvous = app.add_subcommand("rendezvous",
                                            "Fuses two maps of corners at a rendezvous: the experiment of "
                                            "Zhou and Roumeliotis (2006), 4,800 square metres.");
  arguments->add_seeds(*rendezvous);
  rendezvous->callback([arguments] { rendezvous_campaign(*arguments); });
}

}  // namespace isthmus
