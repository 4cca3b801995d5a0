#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/floor_plans/floor_plans.hpp"

namespace isthmus {
namespace {

void print(std::uint64_t seed, const PlanScore& s) {
  std::printf("%-10llu %6zu %9.1f %8.4f %8.4f %8.2f %8.1f %8.2f %8.1f %8.2f %9zu %6zu %7.2f\n",
              static_cast<unsigned long long>(seed), s.walls, s.drawn_m, s.rms_m, s.worst_5_m,
              100 * s.false_share, s.seen_m, 100 * s.found_share, s.walls_seen_m, 100 * s.walls_found_share,
              s.openings, s.poles, s.plan_cpu_s);
  std::fflush(stdout);
}

void floor_plans_campaign(const CampaignRuns& arguments) {
  for (const std::string& name : arguments.scenarios) {
    std::printf("%s\n%-10s %6s %9s %8s %8s %8s %8s %8s %8s %8s %9s %6s %7s\n", name.c_str(), "seed", "walls",
                "drawn m", "RMS m", "95 % m", "false %", "seen m", "found %", "walls m", "found %",
                "openings", "poles", "CPU s");
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed)
      print(seed, try_floor_plan(arguments.load(name, seed), seed));
  }
}

}  // namespace

void add_floor_plans_command(CLI::App& app) {
  const auto arguments = std::make_shared<CampaignRuns>();
  CLI::App* plans = app.add_subcommand("floor-plans",
                                       "Maps runs and draws their floor plans: how far walls lie from the "
                                       "true surfaces, and how much of what\n"
                                       "was seen they show; {seed} in --set stands for the run's seed.");
  arguments->add_scenarios(*plans);
  arguments->add_runs(*plans);
  plans->callback([arguments] { floor_plans_campaign(*arguments); });
}

}  // namespace isthmus
