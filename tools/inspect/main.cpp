#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <vector>

#include "server/output/grid/grid_files.hpp"
#include "server/output/report.hpp"
#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "tools/inspect/confidence_picture.hpp"
#include "tools/inspect/confidence_text.hpp"
#include "tools/inspect/overview.hpp"
#include "tools/inspect/pose_graph.hpp"
#include "tools/replay/read_map.hpp"
#include "tools/text/csv.hpp"
#include "tools/text/progress.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string path;
  std::string config_file;
  std::vector<std::int32_t> confidence;
  std::string picture;
  bool force = false;
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

PatchId first(const Arguments& arguments) { return PatchId{arguments.confidence[0]}; }
PatchId second(const Arguments& arguments) { return PatchId{arguments.confidence[1]}; }

/// An island: K, its patches, and when they were made.
struct ListedIsland {
  int rank = -1;
  std::vector<PatchId> patches;
  std::int64_t from_utime = std::numeric_limits<std::int64_t>::max();
  std::int64_t to_utime = std::numeric_limits<std::int64_t>::min();

  void add(PatchId patch, std::int64_t utime) {
    patches.push_back(patch);
    from_utime = std::min(from_utime, utime);
    to_utime = std::max(to_utime, utime);
  }
};
/// That of a patch, as patches.csv lists it.
ListedIsland island_of(const std::string& directory, PatchId patch) {
  std::map<int, ListedIsland> islands;
  int found = -1;
  CsvReader csv(directory + "/patches.csv");
  while (csv.next()) {
    const int rank = static_cast<int>(csv.integer("island"));
    islands[rank].rank = rank;
    islands[rank].add(PatchId{static_cast<std::int32_t>(csv.integer("id"))}, csv.integer("utime_us"));
    if (islands[rank].patches.back() == patch) found = rank;
  }
  return found >= 0 ? islands[found] : ListedIsland{};
}

std::string confidence_on_disk(const Arguments& arguments) {
  const PoseGraph map = read_pose_graph(arguments.path + "/graph.g2o");
  std::string text = confidence_text(map.graph, map.poses, first(arguments), second(arguments));
  if (arguments.picture.empty()) return text;
  const ListedIsland island = island_of(arguments.path, first(arguments));
  const OccupancyGrid grid = read_grid(arguments.path + "/island-" + std::to_string(island.rank));
  write_confidence_picture(
      {map.graph, map.poses, island.patches, grid, island.rank, island.from_utime, island.to_utime},
      first(arguments), second(arguments), arguments.picture);
  return text;
}

std::string confidence(const Arguments& arguments, const MapCopy& map) {
  std::string text = confidence_text(map.graph, map.poses, first(arguments), second(arguments));
  const RankedIslands islands = rank_islands(map);
  const int k = islands.rank(first(arguments));
  if (arguments.picture.empty() || k < 0) return text;
  ListedIsland island;
  island.rank = k;
  for (const PatchId patch : islands.patches[static_cast<std::size_t>(k)])
    island.add(patch, map.patches[static_cast<std::size_t>(patch.value)]->utime);
  write_confidence_picture({map.graph, map.poses, island.patches, render_island(map, island.patches),
                            island.rank, island.from_utime, island.to_utime},
                           first(arguments), second(arguments), arguments.picture);
  return text;
}

std::string why_no_patch_id(const std::string& text) {
  const bool digits = !text.empty() && text.size() < 10 &&
                      std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; });
  return digits ? "" : "'" + text + "' is no patch's id: a number, as in patches.csv";
}

/// An output directory is read as it is; of anything else the map is made.
std::string inspect(const Arguments& arguments) {
  if (!arguments.picture.empty()) check_new_file(arguments.picture, arguments.force);
  const std::string report = arguments.path + "/report.json";
  if (std::filesystem::exists(report)) {
    if (arguments.confidence.empty())
      return overview(read_text(report), read_meeting_counts(arguments.path), report);
    return confidence_on_disk(arguments);
  }
  const ReplayResult result = replayed(arguments);
  const MapCopy map = result.engine.copy();
  if (!arguments.confidence.empty()) return confidence(arguments, map);
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
  auto* confidence =
      app.add_option("--confidence", arguments.confidence,
                     "A B: how well patch B is determined with respect to patch A (ids as in patches.csv)")
          ->expected(2)
          ->type_name("PATCH")
          ->check(CLI::Validator(why_no_patch_id, ""));
  app.add_option("--picture", arguments.picture,
                 "PNG to write: the island with the ellipses in which patches lie with 95 %, relative to A")
      ->type_name("FILE")
      ->needs(confidence);
  add_force(app, arguments.force);
  app.add_option("--config", arguments.config_file, "TOML configuration, instead of the journal's own");
  return run_program(app, argc, argv, [&] { std::fputs(inspect(arguments).c_str(), stdout); });
}
