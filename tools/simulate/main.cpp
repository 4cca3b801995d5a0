#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <stdexcept>

#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "server/wire/journal/event_log.hpp"
#include "tools/simulate/live/live_drive.hpp"
#include "tools/simulate/run/simulation.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"
#include "tools/simulate/truth/truth_files.hpp"
#include "tools/simulate/wild/campaign.hpp"

namespace {

struct Arguments {
  std::string scenario;
  std::uint64_t seed = 1;
  std::string log;
  std::string truth;
  std::vector<std::string> overrides;
  bool list = false;
  bool force = false;
  bool live = false;
  isthmus::LiveDriveOptions drive;
};

constexpr const char* wild = "wild";
constexpr const char* wild_campus = "wild_campus";

void list() {
  for (const auto& scenario : isthmus::list_scenarios()) {
    std::cout << scenario.name << std::string(scenario.name.size() < 20 ? 20 - scenario.name.size() : 1, ' ')
              << scenario.summary << '\n';
  }
  std::cout << "wild                an unseen building, its robots and their faults, all drawn from --seed\n"
               "wild_campus         the same of a campus, and lasers that see far\n";
}

void run(const Arguments& arguments) {
  isthmus::check_new_file(arguments.log, arguments.force);
  isthmus::check_new_files_in(arguments.truth, {".tum", ".csv", ".png"}, arguments.force);
  const bool is_campus = arguments.scenario == wild_campus;
  if (arguments.scenario == wild || is_campus) {
    if (!arguments.overrides.empty()) throw std::runtime_error("--set: what is wild is drawn from its seed");
    const auto place = is_campus ? isthmus::WildPlace::campus : isthmus::WildPlace::building;
    return isthmus::write_wild(isthmus::draw_wild(arguments.seed, place), arguments.log, arguments.truth);
  }
  const isthmus::Scenario scenario = isthmus::load_scenario(arguments.scenario, arguments.overrides);
  const isthmus::SimulatedRun run = isthmus::simulate(scenario, arguments.seed);
  if (!arguments.truth.empty())
    isthmus::write_truth(scenario, run, isthmus::sample_relations(run.truth, arguments.seed),
                         arguments.truth);
  isthmus::EventLogWriter log(arguments.log);
  for (const isthmus::Event& event : run.events) log.write(isthmus::encode(event));
  log.finish();
}

void drive(const Arguments& arguments) {
  isthmus::check_new_files_in(arguments.drive.pictures, {".png"}, arguments.force);
  const isthmus::Scenario scenario = isthmus::load_scenario(arguments.scenario, arguments.overrides);
  const isthmus::LiveDriveScore score = isthmus::drive_live(scenario, arguments.seed, arguments.drive);
  std::printf(
      "seen %.1f %% of %.0f m2 in %.0f s (%.0f s of the clock), %.0f m driven to %zu goals, walls touched "
      "%zu, "
      "robots touched %zu%s%s%s\n",
      100 * score.share, score.reachable_m2, score.end_s, score.wall_s, score.way_m, score.goals,
      score.touched_walls, score.touched_robots, score.finished ? ", finished" : ", out of time",
      score.out_of_reach > 0 ? (", out of reach " + std::to_string(score.out_of_reach) + " times").c_str()
                             : "",
      score.late_ticks > 0 ? (", late " + std::to_string(score.late_ticks) + " times").c_str() : "");
}

void add_live_options(CLI::App& app, Arguments& arguments) {
  isthmus::LiveDriveOptions& drive = arguments.drive;
  const CLI::Validator positive = isthmus::number_above(0);
  app.add_flag("--live", arguments.live,
               "Drive over LCM by the goals of a server with [exploration] instead:");
  app.add_option("--lcm-url", drive.lcm_url, "Its LCM network")->type_name("URL");
  app.add_option("--speed", drive.speed, "So many seconds of the run in one (1)")
      ->type_name("X")
      ->check(positive);
  app.add_option("--max-time", drive.max_s, "The run is given up then (600)")
      ->type_name("S")
      ->check(positive);
  app.add_option("--robots", drive.robots, "Only the scenario's first")
      ->type_name("N")
      ->check(isthmus::integer_from(1));
  app.add_flag("--side-by-side", drive.side_by_side, "They start beside the first one");
  app.add_option("--radio-range", drive.radio_range_m,
                 "Beyond it from there a robot is not heard and hears nothing")
      ->type_name("M")
      ->check(positive);
  app.add_option("--pictures", drive.pictures, "Where to draw the run, every 60 s")->type_name("DIR");
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Simulates robots in a building: writes an LCM event log with the truth beside it, or drives them "
      "live.",
      "isthmus-simulate");
  auto* list_option = app.add_flag("--list", arguments.list, "Name the scenarios that come with Isthmus");
  app.add_option("--scenario", arguments.scenario, "A scenario's name, or a TOML file");
  app.add_option("--seed", arguments.seed, "Varies noise and waypoints; the same seed gives the same log")
      ->capture_default_str();
  app.add_option("-o,--output", arguments.log, "The log to write")->type_name("FILE");
  app.add_option("--truth", arguments.truth, "Where to write true poses, relations and the floor plan")
      ->type_name("DIR");
  app.add_option("--set", arguments.overrides, "Override settings of the scenario: laps=10 robots.R1.laps=3")
      ->type_name("KEY=VALUE");
  isthmus::add_force(app, arguments.force);
  add_live_options(app, arguments);
  app.callback([&] {
    if (list_option->count() > 0) return;
    if (arguments.scenario.empty()) throw CLI::RequiredError("--scenario");
    const bool live_only = app.count("--speed") + app.count("--max-time") + app.count("--robots") +
                               app.count("--lcm-url") + app.count("--side-by-side") +
                               app.count("--radio-range") + app.count("--pictures") >
                           0;
    if (live_only && !arguments.live) throw CLI::RequiredError("--live");
    if (arguments.log.empty() != arguments.live)
      throw CLI::ValidationError("--output", "one of --output and --live is needed");
  });
  return isthmus::run_program(app, argc, argv, [&] {
    if (arguments.list) return list();
    arguments.live ? drive(arguments) : run(arguments);
  });
}
