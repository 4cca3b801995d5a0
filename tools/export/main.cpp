#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <vector>

#include "server/output/format/atomic_file.hpp"
#include "server/output/vector_plan/plan_files.hpp"
#include "tools/replay/read_map.hpp"
#include "tools/text/finite_number.hpp"
#include "tools/text/progress.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string log;
  std::string output;
  std::string config_file;
  double resolution_m = 0.05;
  std::vector<double> align = {0, 0, 0};
  bool floor_plan = false;
};

ReplayResult replayed(const Arguments& arguments) {
  Progress progress("export");
  ReplayOptions options;
  options.config_file = arguments.config_file;
  options.progress = [&](double share) { progress.update(share); };
  options.finishing = [&](const std::string& what) { progress.say(what); };
  options.warn = [](const std::string& warning) {
    std::fprintf(stderr, "isthmus-export: %s\n", warning.c_str());
  };
  return read_map(arguments.log, options);
}

void run(const Arguments& arguments) {
  make_directory(arguments.output);  // an output that cannot be written is better known before the replay
  const ReplayResult result = replayed(arguments);
  OutputOptions options;
  options.resolution_m = arguments.resolution_m;
  options.align = {arguments.align[0], arguments.align[1], wrap_angle(arguments.align[2])};
  const MapCopy map = result.engine.copy();
  write_outputs(map, result.cost, arguments.output, options);
  if (arguments.floor_plan) write_plans(aligned(map, options.align), arguments.output);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Writes the map of a journal or log: grids, trajectories, tables, graph and report.",
               "isthmus-export");
  Arguments arguments;
  app.add_option("journal", arguments.log, "a journal directory, a snapshot of one, or an LCM event log")
      ->required();
  app.add_option("--output", arguments.output, "directory for the files, made where missing")->required();
  app.add_option("--resolution", arguments.resolution_m, "size of a grid cell in metres")
      ->check(finite_number & CLI::Range(0.005, 10.0))
      ->capture_default_str();
  app.add_option("--align", arguments.align,
                 "X,Y,YAW (metres, radians): moves every island's frame by this before writing")
      ->delimiter(',')
      ->expected(3)
      ->check(finite_number & CLI::Range(-1e6, 1e6));
  app.add_flag("--floor-plan", arguments.floor_plan,
               "also write each island's walls, openings and poles as SVG, DXF and GeoJSON");
  app.add_option("--config", arguments.config_file, "TOML configuration, instead of the journal's own");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "isthmus-export: %s\n", error.what());
    return 1;
  }
  return 0;
}
