#include "tools/simulate/evidence/command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/evidence/evidence.hpp"
#include "tools/simulate/wild/site.hpp"

namespace isthmus {
namespace {

struct EvidenceArguments : CampaignRuns {
  bool wild = false;
  double false_share = 0;
  CampaignConfiguration configuration;
  std::string output;
  std::string finds;
};

/// Maps runs as they come, and keeps what their closures were.
class Labelling {
 public:
  Labelling(std::string file, std::string finds_file, Configuration configuration)
      : file_(std::move(file)),
        finds_file_(std::move(finds_file)),
        configuration_(std::move(configuration)) {}

  void add(const std::string& name, std::uint64_t seed, const SimulatedRun& run) {
    const std::string label = name + " " + std::to_string(seed);
    const MapCopy map = map_events(run.events, configuration_);
    std::vector<LabelledClosure> found = label_closures(label, map, run.truth);
    const std::vector<LabelledFind> finds = label_finds(label, map, run.truth);
    std::size_t true_ones = 0;
    for (const LabelledClosure& one : found) true_ones += one.is_true() ? 1U : 0U;
    std::printf("%-28s %8zu %6zu\n", label.c_str(), found.size(), true_ones);
    std::fflush(stdout);
    closures_.insert(closures_.end(), std::make_move_iterator(found.begin()),
                     std::make_move_iterator(found.end()));
    write_labelled_closures(closures_, file_);  // a long campaign that is broken off has what it has found
    finds_.insert(finds_.end(), finds.begin(), finds.end());
    if (!finds_file_.empty()) write_labelled_finds(finds_, finds_file_);
  }

 private:
  std::string file_;
  std::string finds_file_;
  Configuration configuration_;
  std::vector<LabelledClosure> closures_;
  std::vector<LabelledFind> finds_;
};

void evidence_campaign(const EvidenceArguments& arguments) {
  for (const std::string& file : {arguments.output, arguments.finds}) check_new_file(file, arguments.force);
  Labelling labelling(arguments.output, arguments.finds, arguments.configuration.load());
  std::printf("%-28s %8s %6s\n", "run", "closures", "true");
  const std::uint64_t end = arguments.first_seed + arguments.seeds;
  for (const std::string& name : arguments.scenarios) {
    for (std::uint64_t seed = arguments.first_seed; seed < end; ++seed) {
      Scenario scenario = arguments.load(name, seed);
      if (arguments.false_share > 0) scenario.false_sightings = arguments.false_share;
      labelling.add(name, seed, simulate(scenario, seed));
    }
  }
  for (std::uint64_t seed = arguments.first_seed; arguments.wild && seed < end; ++seed) {
    const WildDraw draw = draw_wild(seed);
    labelling.add("wild", seed, simulate_wild(draw, make_wild_scenario(draw)));
  }
}

}  // namespace

void add_evidence_command(CLI::App& app) {
  const auto arguments = std::make_shared<EvidenceArguments>();
  CLI::App* evidence = app.add_subcommand(
      "evidence",
      "Maps runs and writes, for each closure that was tried out, what its trial found and whether it is "
      "true; and the same of each place that scans found.");
  evidence->add_option("--scenario", arguments->scenarios, "Scenarios to run");
  arguments->add_runs(*evidence);
  evidence->add_flag("--wild", arguments->wild, "Run buildings drawn from the seeds, too");
  evidence->add_option("--false", arguments->false_share, "Share of false sightings in the scenarios")
      ->check(number_in(0.0, 0.95));
  arguments->configuration.add_to(*evidence);
  evidence->add_option("-o,--output", arguments->output, "Table to write, a row for each closure")
      ->type_name("FILE")
      ->required();
  evidence->add_option("--finds", arguments->finds, "Table to write, a row for each place that scans found")
      ->type_name("FILE");
  add_force(*evidence, arguments->force);
  evidence->callback([arguments] { evidence_campaign(*arguments); });
}

}  // namespace isthmus
