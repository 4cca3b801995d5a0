#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "server/output/format/atomic_file.hpp"
#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "tools/replay/read_map.hpp"
#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/campaigns/paths/paths.hpp"

namespace isthmus {
namespace {

struct PathsArguments : CampaignRuns {
  std::vector<std::string> maps;
  std::vector<double> until_s;
  std::size_t pairs = 1000;
  Footprint footprint;
  std::string pictures;
  double teammates_s = 0;  ///< 0: paths are judged
};

std::string text(const std::map<Refusal, std::size_t>& missing) {
  std::string found;
  for (const auto& [refusal, count] : missing)
    found += (found.empty() ? "" : " ") + std::string(word(refusal)) + "=" + std::to_string(count);
  return found.empty() ? "0" : found;
}

void print(const std::string& what, const PathScore& s) {
  std::printf("%-28s %6zu %8zu %9zu %9zu %7.4f %7.3f %7.2f %7.2f %7.2f %8.0f %8.0f  %s\n", what.c_str(),
              s.pairs, s.through, s.too_near, s.too_long, s.mean_ratio, s.worst_ratio, s.p50_ms, s.p99_ms,
              s.max_ms, s.keep_ms, s.roadmap_ms, text(s.missing).c_str());
  if (s.too_long > 0)
    std::printf("  worst: from (%.2f, %.2f) to (%.2f, %.2f)\n", s.worst[0].x(), s.worst[0].y(),
                s.worst[1].x(), s.worst[1].y());
  std::fflush(stdout);
}

void print_teammates(const std::string& what, const TeammateScore& score) {
  const Confidence c = score.tally.result();
  std::printf("%-28s %6zu %5.1f%% %5.1f%% %5.1f%% %8.2f %7.3f %7.3f  %zu\n", what.c_str(), c.pairs,
              100 * c.within_95[0], 100 * c.within_95[1], 100 * c.within_95[2], c.mean_nees, c.mean_error_m,
              c.mean_error_rad * 180 / std::numbers::pi, score.unknown);
  std::fflush(stdout);
}

void judge_map(const PathsArguments& arguments, const std::string& what, MapCopy map, std::uint64_t seed) {
  if (!arguments.pictures.empty()) make_directory(arguments.pictures);
  const std::string picture = arguments.pictures.empty() ? "" : arguments.pictures + "/" + what + ".png";
  print(what, score_paths(std::make_shared<const MapCopy>(std::move(map)), arguments.pairs, seed,
                          arguments.footprint, picture));
}

void judge_run(const PathsArguments& arguments, const std::string& name, std::uint64_t seed,
               TeammateScore& total) {
  const Scenario scenario = arguments.load(name, seed);
  const SimulatedRun run = simulate(scenario, seed);
  const std::string what = name + "-" + std::to_string(seed);
  for (const double until_s : arguments.until_s) {
    const DriveScore s =
        score_drives(run, scenario.plan, until_s, arguments.pairs, seed, arguments.footprint);
    std::printf("%-28s at %5.0f s: %zu paths, %s missing, %zu touch something, %.0f m\n", what.c_str(),
                until_s, s.paths, text(s.missing).c_str(), s.touching, s.metres);
  }
  if (arguments.teammates_s > 0) {
    TeammateScore score = score_teammates(run, arguments.teammates_s);
    print_teammates(what, score);
    total.tally.add(score.tally);
    total.unknown += score.unknown;
    return;
  }
  if (arguments.until_s.empty()) judge_map(arguments, what, map_events(run.events), seed);
}

void paths_campaign(const PathsArguments& arguments) {
  check_new_files_in(arguments.pictures, {".png"}, arguments.force);
  TeammateScore total;
  if (arguments.teammates_s > 0)
    std::printf("%-28s %6s %6s %6s %6s %8s %7s %7s  unknown\n", "", "pairs", "x", "y", "yaw", "NEES/3",
                "mean m", "deg");
  else if (arguments.until_s.empty())
    std::printf("%-28s %6s %8s %9s %9s %7s %7s %7s %7s %7s %8s %8s  missing\n", "", "pairs", "through",
                "too near", "too long", "ratio", "worst", "p50 ms", "p99 ms", "max ms", "keep ms", "road ms");
  for (const std::string& map : arguments.maps)
    judge_map(arguments, std::filesystem::path(map).stem().string(), read_map(map, {}).map(),
              arguments.first_seed);
  for (const std::string& name : arguments.scenarios)
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed)
      judge_run(arguments, name, seed, total);
  if (arguments.teammates_s > 0) print_teammates("all", total);
}

}  // namespace

void add_paths_command(CLI::App& app) {
  const auto arguments = std::make_shared<PathsArguments>();
  arguments->seeds = 1;
  CLI::App* paths = app.add_subcommand("paths",
                                       "Asks for paths between random places of maps: whether they keep "
                                       "clear of what the finished map shows, how\n"
                                       "long they are beside the shortest way over it, and what a question "
                                       "costs. With --until, whether paths on\n"
                                       "the map as it was then can be driven in the simulated building.");
  paths->add_option("--map", arguments->maps, "log, journal or snapshot; several")->allow_extra_args(false);
  paths->add_option("--scenario", arguments->scenarios, "scenario to run; several")->allow_extra_args(false);
  arguments->add_runs(*paths);
  paths->add_option("--until", arguments->until_s, "seconds of a run; several")
      ->check(number_from(0))
      ->allow_extra_args(false);
  paths
      ->add_option(
          "--teammates", arguments->teammates_s,
          "instead: every so many seconds, how often the truth lies in the 95 % intervals of robots'\n"
          "relative poses")
      ->check(number_above(0));
  paths->add_option("--pairs", arguments->pairs, "of each map")
      ->check(integer_from(1))
      ->capture_default_str();
  paths->add_option("--radius", arguments->footprint.radius_m, "of the robot, m")
      ->check(number_in(0.0, 1.0))
      ->capture_default_str();
  paths->add_option("--clearance", arguments->footprint.clearance_m, "from walls, m")
      ->check(number_in(0.0, 1.0))
      ->capture_default_str();
  paths->add_option("--pictures", arguments->pictures,
                    "directory for a picture of each map with eight paths");
  add_force(*paths, arguments->force);
  paths->callback([arguments] { paths_campaign(*arguments); });
}

}  // namespace isthmus
