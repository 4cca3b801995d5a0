#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/output/format/atomic_file.hpp"
#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/explore/exploration_picture.hpp"
#include "tools/simulate/campaigns/explore/order_table.hpp"
#include "tools/simulate/live/exploration_run.hpp"

namespace isthmus {
namespace {

struct ExploreArguments : CampaignRuns {
  std::vector<std::size_t> robots = {1, 2, 4};
  bool nearest = false;
  bool both = false;
  std::string pictures;
  double picture_s = 60;
  std::string orders;
  ExplorationRunOptions run;
};

const char* word_of(Sharing sharing) { return sharing == Sharing::routes ? "routes" : "nearest"; }

void print_header() {
  std::printf("%-20s %2s %-7s %6s %6s %7s %7s %7s %7s %3s %7s %5s %6s %5s %5s %6s %7s\n", "", "n", "sharing",
              "m2", "share", "99% s", "99% m", "end s", "way m", "isl", "one s", "walls", "robots", "gives",
              "goals", "vain", "plan ms");
}

void print(const std::string& what, std::size_t robots, Sharing sharing, const ExplorationScore& s) {
  std::printf(
      "%-20s %2zu %-7s %6.0f %6.4f %7.0f %7.0f %7.0f %7.0f %3zu %7.0f %5zu %6zu %5zu %5zu %6zu %7.0f%s\n",
      what.c_str(), robots, word_of(sharing), s.reachable_m2, s.share, s.found_s, s.found_way_m, s.end_s,
      s.way_m, s.islands, s.merged_s, s.touched_walls, s.touched_robots, s.gave_way, s.goals,
      s.goals_given_up, s.plan_cpu_ms, s.given_up ? "  out of time" : "");
  std::fflush(stdout);
}

void explore_once(const ExploreArguments& arguments, const std::string& name, std::uint64_t seed,
                  std::size_t robots, Sharing sharing) {
  const Scenario scenario = arguments.load(name, seed);
  ExplorationRunOptions options = arguments.run;
  options.robots = robots;
  options.expedition.exploration.sharing = sharing;
  const std::string what = std::filesystem::path(name).stem().string() + "-" + std::to_string(seed);
  OrderTable orders;
  const auto watch_orders = [&](const OrderView& view) { orders.add(view); };
  double next_s = 0;
  const auto watch = [&](const ExplorationView& view) {
    if (view.time_s < next_s) return;
    next_s = view.time_s + arguments.picture_s;
    char file[96];
    std::snprintf(file, sizeof file, "/%s-%zu-%s-%05.0f.png", what.c_str(), robots, word_of(sharing),
                  view.time_s);
    if (const auto sheet = exploration_sheet(view)) sheet->write(arguments.pictures + file);
  };
  print(what, robots, sharing,
        explore(scenario, seed, options, arguments.pictures.empty() ? WatchExploration{} : watch,
                arguments.orders.empty() ? WatchOrders{} : watch_orders));
  if (!arguments.orders.empty())
    orders.write(arguments.orders + "/" + what + "-" + std::to_string(robots) + "-" + word_of(sharing) +
                 ".csv");
}

void explore_campaign(const ExploreArguments& arguments) {
  check_new_files_in(arguments.pictures, {".png"}, arguments.force);
  check_new_files_in(arguments.orders, {".csv"}, arguments.force);
  for (const std::string& directory : {arguments.pictures, arguments.orders})
    if (!directory.empty()) make_directory(directory);
  print_header();
  for (const std::string& name : arguments.scenarios)
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed)
      for (const std::size_t robots : arguments.robots)
        for (const Sharing sharing : {Sharing::routes, Sharing::nearest})
          if (arguments.both || (sharing == Sharing::nearest) == arguments.nearest)
            explore_once(arguments, name, seed, robots, sharing);
}

}  // namespace

void add_explore_command(CLI::App& app) {
  const auto arguments = std::make_shared<ExploreArguments>();
  arguments->seeds = 1;
  CLI::App* explore = app.add_subcommand(
      "explore",
      "Lets robots explore simulated buildings by themselves, by the goals and paths of the map that they\n"
      "make, and tells what they found, how long it took, how far they drove, and what they touched.");
  arguments->add_scenarios(*explore);
  arguments->add_runs(*explore);
  explore
      ->add_option("--robots", arguments->robots,
                   "of the scenario's, side by side; repeat for several numbers")
      ->check(integer_from(1))
      ->allow_extra_args(false);
  explore->add_flag("--apart", arguments->run.apart, "robots start where the scenario has them");
  explore->add_flag("--nearest", arguments->nearest, "instead: each to the frontier nearest to it");
  explore->add_flag("--both", arguments->both, "both ways, one after the other");
  explore->add_option("--clearance", arguments->run.clearance_m, "from walls, m")
      ->check(number_in(0.0, 1.0))
      ->capture_default_str();
  explore->add_option("--max-time", arguments->run.max_s, "a run is given up then, s")
      ->check(number_above(0))
      ->capture_default_str();
  explore->add_option("--pictures", arguments->pictures, "directory for pictures of each run");
  explore->add_option("--picture-time", arguments->picture_s, "between pictures, s")
      ->check(number_above(0))
      ->capture_default_str();
  explore->add_option("--orders", arguments->orders,
                      "directory for a table of each run: who was told what when");
  add_force(*explore, arguments->force);
  explore->callback([arguments] { explore_campaign(*arguments); });
}

}  // namespace isthmus
