#include <CLI/CLI.hpp>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include "server/engine/input/tuning.hpp"
#include "server/output/format/csv.hpp"
#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "tools/replay/feature_replay.hpp"
#include "tools/replay/summary.hpp"
#include "tools/text/progress.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string log;
  std::string output;
  std::string config_file;
  std::string memory_file;
  std::vector<std::int32_t> forbid;
  double until_s = std::numeric_limits<double>::infinity();
  bool refine = false;
  bool json = false;
  bool force = false;
  std::optional<FeatureMapKind> features;  ///< the estimator; none: the manifold map
  bool estimator_given = false;            ///< else it is as the log's configuration says
};

/// Memory by event time, a row a minute.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& path)
      : file_(path, "event_s,resident_mb,patches,relations,sightings,closures") {}

  void add(const Engine& engine, double event_s) {
    const MapCopy map = engine.copy();
    file_.row(event_s, process_rss_mb(), map.patches.size(), map.graph.relations().size(),
              map.counters.sightings, map.closures.size());
  }
  void commit() { file_.commit(); }

 private:
  CsvFile file_;
};

/// Its configuration is an event of every log.
bool holds_nothing(const Counters& counters) { return counters.events <= 1 && counters.dropped.empty(); }

void run(const Arguments& arguments) {
  ReplayOptions options;
  options.config_file = arguments.config_file;
  for (const std::int32_t id : arguments.forbid) options.forbid.push_back({id});
  options.until_s = arguments.until_s;
  options.refine = arguments.refine;
  options.warn = [](const std::string& warning) {
    std::fprintf(stderr, "isthmus-replay: %s\n", warning.c_str());
  };
  std::optional<MemoryFile> memory;
  if (!arguments.memory_file.empty()) {
    memory.emplace(arguments.memory_file);
    options.sample = [&](const Engine& engine, double event_s) { memory->add(engine, event_s); };
  }
  ReplayResult result = [&] {
    Progress progress("replay");
    options.progress = [&](double share) { progress.update(share); };
    options.finishing = [&](const std::string& what) { progress.say(what); };
    return replay(arguments.log, options);
  }();
  if (memory) memory->commit();
  const MapCopy map = result.map();
  write_outputs(map, result.cost, arguments.output);
  std::fputs((arguments.json ? summary_json(result, map) : summary_text(result, map)).c_str(), stdout);
  if (holds_nothing(map.counters))
    throw std::runtime_error(arguments.log + ": holds no message of a robot (lcmtypes/README.md: channels)");
}

void run_features(const Arguments& arguments) {
  if (arguments.refine || arguments.json || !arguments.config_file.empty() || !arguments.memory_file.empty())
    throw std::runtime_error("--refine, --json, --config and --memory are for the manifold map");
  FeatureReplayOptions options;
  options.map = feature_map_options(*arguments.features);
  options.forbid = {arguments.forbid.begin(), arguments.forbid.end()};
  options.until_s = arguments.until_s;
  options.warn = [](const std::string& warning) {
    std::fprintf(stderr, "isthmus-replay: %s\n", warning.c_str());
  };
  const FeatureReplayResult result = [&] {
    Progress progress("replay");
    options.progress = [&](double share) { progress.update(share); };
    return replay_features(arguments.log, options);
  }();
  write_outputs(result.maps, result.cost, arguments.output);
  std::fputs(summary_text(result).c_str(), stdout);
}

/// Prints them instead of mapping a log.
[[noreturn]] void list_tuning() {
  std::fputs(tuning_text({}).c_str(), stdout);
  throw CLI::Success();
}

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("log", arguments.log, "an LCM event log, or a journal directory")->required();
  app.add_option("-o,--output", arguments.output, "directory for the map, trajectories and report")
      ->required();
  app.add_option("--config", arguments.config_file, "TOML configuration, instead of the log's own");
  app.add_option("--forbid", arguments.forbid, "id of a closure that must not be made; repeat for several");
  app.add_option("--until", arguments.until_s,
                 "read no further than so many seconds of event time after the log's first event")
      ->type_name("SECONDS")
      ->check(number_from(0));
  app.add_option("--memory", arguments.memory_file,
                 "CSV file for the resident memory at every minute of event time")
      ->type_name("FILE");
  app.add_flag("--refine", arguments.refine,
               "at the end, match and fit the whole map once more and match every scan with it");
  app.add_option_function<std::string>(
         "--estimator",
         [&arguments](const std::string& name) {
           if (name == "segments") arguments.features = FeatureMapKind::segments;
           if (name == "points") arguments.features = FeatureMapKind::points;
           arguments.estimator_given = true;
         },
         "manifold, or a map of features beside it: segments (walls in scans) or points (fixed barcodes)")
      ->check(one_of({"manifold", "segments", "points"}))
      ->default_str("as the log says");
  app.add_flag("--json", arguments.json, "print the summary as JSON");
  add_force(app, arguments.force);
  app.add_flag_callback("--list-tuning", list_tuning,
                        "only print the values that [tuning] of the configuration can set, for experiments");
}

}  // namespace

int main(int argc, char** argv) {
  share_memory_among_threads();
  CLI::App app("Maps a recorded log: the server's engine, reading as fast as it can.", "isthmus-replay");
  Arguments arguments;
  add_options(app, arguments);
  return run_program(app, argc, argv, [&] {
    check_new_directory(arguments.output, arguments.force);
    if (!arguments.memory_file.empty()) check_new_file(arguments.memory_file, arguments.force);
    if (!arguments.estimator_given)
      arguments.features = feature_kind_of(arguments.log, arguments.config_file);
    if (arguments.features)
      run_features(arguments);
    else
      run(arguments);
  });
}
