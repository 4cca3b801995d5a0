#include <CLI/CLI.hpp>
#include <iostream>
#include <stdexcept>

#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/wire/journal/event_log.hpp"
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
};

constexpr const char* wild = "wild";

void list() {
  for (const auto& scenario : isthmus::list_scenarios()) {
    std::cout << scenario.name << std::string(scenario.name.size() < 20 ? 20 - scenario.name.size() : 1, ' ')
              << scenario.summary << '\n';
  }
  std::cout << "wild                an unseen building, its robots and their faults, all drawn from --seed\n";
}

void run(const Arguments& arguments) {
  isthmus::check_new_file(arguments.log, arguments.force);
  if (arguments.scenario == wild) {
    if (!arguments.overrides.empty())
      throw std::runtime_error("--set: a wild building is drawn from its seed");
    return isthmus::write_wild(isthmus::draw_wild(arguments.seed), arguments.log, arguments.truth);
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

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Simulates robots in a building and writes an LCM event log, with the truth beside it.",
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
  app.callback([&] {
    if (list_option->count() > 0) return;
    if (arguments.scenario.empty()) throw CLI::RequiredError("--scenario");
    if (arguments.log.empty()) throw CLI::RequiredError("--output");
  });
  return isthmus::run_program(app, argc, argv, [&] { arguments.list ? list() : run(arguments); });
}
