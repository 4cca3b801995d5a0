#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "server/program/values.hpp"
#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/features/rendezvous_experiment.hpp"

namespace isthmus {
namespace {

void print(const std::string& what, const RendezvousScore& s) {
  std::printf("%-10s %7zu %7zu %7zu %7zu %6zu %9.2f %9.3f %9.3f %8.2f %8.2f %8.2f\n", what.c_str(),
              s.corners_1, s.corners_2, s.duplicates, s.found, s.wrong, s.before_3_sigma_m, s.after_3_sigma_m,
              s.least_3_sigma_m, s.nees_before, s.nees_after, s.fusion_cpu_ms);
  std::fflush(stdout);
}

struct RendezvousArguments : CampaignRuns {
  RendezvousConditions experiment;
};

void rendezvous_campaign(const RendezvousArguments& arguments) {
  std::printf("%-10s %7s %7s %7s %7s %6s %9s %9s %9s %8s %8s %8s\n", "seed", "map 1", "map 2", "twins",
              "found", "wrong", "3 sigma m", "fused m", "least m", "NEES/3", "fused", "CPU ms");
  std::vector<RendezvousScore> scores;
  for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    scores.push_back(judge_fusion(run_rendezvous_experiment(seed, arguments.experiment)));
    scores.back().least_3_sigma_m = least_3_sigma_m(seed, arguments.experiment);
    print(std::to_string(seed), scores.back());
  }
  print("all", mean_of(scores));
}

}  // namespace

void add_rendezvous_command(CLI::App& app) {
  const auto arguments = std::make_shared<RendezvousArguments>();
  CLI::App* rendezvous = app.add_subcommand("rendezvous",
                                            "Fuses two maps of corners at a rendezvous: the experiment of "
                                            "Zhou and Roumeliotis (2006), 4,800 square metres.");
  arguments->add_seeds(*rendezvous);
  rendezvous
      ->add_option(
          "--corner-sigma", arguments->experiment.corner_sigma_m,
          "How a corner errs in a scan, in each axis, m; 0: as a laser's beams have it, by its range")
      ->check(number_in(0.0, 1.0))
      ->capture_default_str();
  rendezvous
      ->add_option("--looks", arguments->experiment.looks_at_start, "Scans that a robot takes before it goes")
      ->check(integer_in(1, 1000))
      ->capture_default_str();
  rendezvous->callback([arguments] { rendezvous_campaign(*arguments); });
}

}  // namespace isthmus
