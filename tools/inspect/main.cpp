#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "server/output/report.hpp"
#include "server/program/command_line.hpp"
#include "tools/inspect/confidence_text.hpp"
#include "tools/inspect/overview.hpp"
#include "tools/inspect/pose_graph.hpp"
#include "tools/replay/read_map.hpp"
#include "tools/text/progress.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string path;
  std::string config_file;
  std::vector<std::int32_t> confidence;
};

std::string read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  return text.str();
}

ReplayResult replayed(const Arguments& arguments) {
  Progress progress("replay");
  ReplayOptions options;
  options.config_file = arguments.config_file;
  options.progress = [&](double share) { progress.update(share); };
  options.warn = [](const std::string& warning) {
    std::fprintf(stderr, "isthmus-inspect: %s\n", warning.c_str());
  };
  return read_map(arguments.path, options);
}

std::string confidence(const Arguments& arguments, const RelationGraph& graph, std::span<const Pose> poses) {
  return confidence_text(graph, poses, PatchId{arguments.confidence[0]}, PatchId{arguments.confidence[1]});
}

/// An output directory is read as it is; of anything else the map is made.
std::string inspect(const Arguments& arguments) {
  const std::string report = arguments.path + "/report.json";
  if (std::filesystem::exists(report)) {
    if (arguments.confidence.empty())
      return overview(read_text(report), read_meeting_counts(arguments.path), report);
    const PoseGraph map = read_pose_graph(arguments.path + "/graph.g2o");
    return confidence(arguments, map.graph, map.poses);
  }
  const ReplayResult result = replayed(arguments);
  const MapCopy map = result.engine.copy();
  if (!arguments.confidence.empty()) return confidence(arguments, map.graph, map.poses);
  return overview(report_json(map, rank_islands(map), result.cost), count_meetings(map), arguments.path);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Shows what is in a map: counters, islands, sessions, closures with their ids.",
               "isthmus-inspect");
  Arguments arguments;
  app.add_option("path", arguments.path,
                 "an output directory, a snapshot, a journal directory, or an LCM log (replayed)")
      ->required();
  app.add_option("--confidence", arguments.confidence,
                 "A B: how well patch B is determined with respect to patch A (ids as in patches.csv)")
      ->expected(2);
  app.add_option("--config", arguments.config_file, "TOML configuration, instead of the journal's own");
  return run_program(app, argc, argv, [&] { std::fputs(inspect(arguments).c_str(), stdout); });
}
