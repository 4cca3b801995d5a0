#include <CLI/CLI.hpp>
#include <cstdio>
#include <vector>

#include "server/output/vector_plan/plan_files.hpp"
#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "server/wire/journal/snapshot.hpp"
#include "tools/export/map_identification.hpp"
#include "tools/export/mcap/map_mcap.hpp"
#include "tools/replay/read_map.hpp"
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
  bool force = false;
  std::string mcap;
  std::string map_link;
  std::string map_name = "isthmus";
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

Pose moved_by(const Arguments& arguments) {
  return {arguments.align[0], arguments.align[1], wrap_angle(arguments.align[2])};
}

void write_directory(const Arguments& arguments, const ReplayResult& result) {
  OutputOptions options;
  options.resolution_m = arguments.resolution_m;
  options.align = moved_by(arguments);
  const MapCopy map = result.engine.copy();
  write_outputs(map, result.cost, arguments.output, options);
  const MapCopy moved = aligned(map, options.align);
  if (!arguments.map_link.empty())
    write_map_identification(moved, arguments.map_name, arguments.map_link, arguments.output);
  if (arguments.floor_plan) write_plans(moved, arguments.output);
}

void write_mcap(const Arguments& arguments, const ReplayResult& result) {
  Progress progress("mcap");
  McapOptions options;
  if (!is_snapshot(arguments.log)) options.log = arguments.log;
  options.resolution_m = arguments.resolution_m;
  options.progress = [&](double share) { progress.update(share); };
  const MapCopy map = aligned(result.engine.copy(), moved_by(arguments));
  const std::uint64_t messages = write_mcap(map, result.engine.configuration(), arguments.mcap, options);
  std::printf("%s: %llu messages\n", arguments.mcap.c_str(), static_cast<unsigned long long>(messages));
}

void run(const Arguments& arguments) {
  // Better known before the replay.
  if (!arguments.output.empty()) check_new_directory(arguments.output, arguments.force);
  if (!arguments.mcap.empty()) check_new_file(arguments.mcap, arguments.force);
  const ReplayResult result = replayed(arguments);
  if (!arguments.output.empty()) write_directory(arguments, result);
  if (!arguments.mcap.empty()) write_mcap(arguments, result);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Writes the map of a journal or log: grids, trajectories, tables, graph and report.",
               "isthmus-export");
  Arguments arguments;
  app.add_option("path", arguments.log, "a journal directory, a snapshot of one, or an LCM event log")
      ->required();
  auto* output =
      app.add_option("-o,--output", arguments.output, "directory for the files, made where missing");
  app.add_option("--mcap", arguments.mcap,
                 "file to write the map, its robots and their scans to, over time, as MCAP for Foxglove and "
                 "Lichtblick")
      ->type_name("FILE");
  app.add_option("--resolution", arguments.resolution_m, "size of a grid cell in metres")
      ->check(number_in(0.005, 10.0))
      ->capture_default_str();
  app.add_option("--align", arguments.align,
                 "X,Y,YAW (metres, radians): moves every island's frame by this before writing")
      ->delimiter(',')
      ->expected(3)
      ->check(number_in(-1e6, 1e6));
  app.add_flag("--floor-plan", arguments.floor_plan,
               "also write each island's walls, openings and poles as SVG, DXF and GeoJSON")
      ->needs(output);
  app.add_option("--config", arguments.config_file, "TOML configuration, instead of the journal's own");
  auto* link =
      app.add_option("--map-link", arguments.map_link,
                     "where the files will be: also write vda5050-maps.json, the maps as VDA 5050 names them")
          ->type_name("URL")
          ->needs(output);
  app.add_option("--map-name", arguments.map_name, "what mapId begins with")
      ->needs(link)
      ->capture_default_str();
  add_force(app, arguments.force);
  return run_program(app, argc, argv, [&] {
    if (arguments.output.empty() && arguments.mcap.empty()) throw CLI::RequiredError("--output or --mcap");
    run(arguments);
  });
}
