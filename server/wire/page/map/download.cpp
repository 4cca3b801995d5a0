#include "server/wire/page/map/download.hpp"

#include <charconv>
#include <utility>

#include "server/output/format/png.hpp"
#include "server/output/grid/grid.hpp"
#include "server/output/grid/grid_files.hpp"
#include "server/output/report.hpp"
#include "server/output/tables/annotation_table.hpp"
#include "server/output/tables/islands.hpp"
#include "server/output/vector_plan/map_source.hpp"
#include "server/output/vector_plan/plan_files.hpp"
#include "server/output/vector_plan/vector_plan.hpp"

namespace isthmus {
namespace {

constexpr std::size_t max_cells = 16'000'000;
constexpr double cell_m = 0.05;

/// "island-3-plan.svg" as 3 and "-plan.svg".
struct IslandFile {
  IslandId island;
  std::string_view suffix;
};

std::optional<IslandFile> island_file(std::string_view name) {
  constexpr std::string_view prefix = "island-";
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  IslandFile file;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), file.island.value);
  if (error != std::errc()) return std::nullopt;
  name.remove_prefix(static_cast<std::size_t>(end - name.data()));
  file.suffix = name;
  return file;
}

std::optional<Download> grid_download(const MapCopy& map, const std::vector<PatchId>& patches,
                                      const std::string& stem, std::string_view suffix) {
  const OccupancyGrid grid = render_island(map, patches, cell_m, max_cells);
  if (suffix == ".yaml") return Download{stem + ".yaml", "text/yaml", grid_yaml(grid, stem + ".png")};
  return Download{stem + ".png", "image/png", grey_png(grid.width, grid.height, grid.pixels)};
}

std::optional<Download> plan_download(const MapCopy& map, const std::vector<PatchId>& patches,
                                      const std::string& stem, std::string_view suffix) {
  const bool svg = suffix == "-plan.svg", dxf = suffix == "-plan.dxf", geojson = suffix == "-plan.geojson";
  if (!svg && !dxf && !geojson) return std::nullopt;
  const PlanOptions options;
  const VectorPlan plan = fit_plan(plan_source(map, patches, options.patch_error), options);
  const std::string name = stem + std::string(suffix);
  if (svg) return Download{name, "image/svg+xml", plan_svg(plan)};
  if (dxf) return Download{name, "image/vnd.dxf", plan_dxf(plan, stem)};
  return Download{name, "application/geo+json", plan_geojson(plan, stem)};
}

}  // namespace

std::optional<Download> make_download(const ShownMap& shown, std::string_view name) {
  const MapCopy& map = shown.map();
  const RankedIslands islands = rank_islands(map);
  if (name == "report.json") {
    RunCost unknown;
    unknown.finished = false;
    return Download{"report.json", "application/json", report_json(map, islands, unknown)};
  }
  if (name == "places.geojson")
    return Download{"places.geojson", "application/geo+json",
                    annotations_geojson(map, [](IslandId island) { return island.value; })};
  const std::optional<IslandFile> file = island_file(name);
  if (!file || !shown.version.contains(file->island)) return std::nullopt;
  const int rank = islands.rank(file->island);
  if (rank < 0) return std::nullopt;
  const std::vector<PatchId>& patches = islands.patches[static_cast<std::size_t>(rank)];
  const std::string stem = "island-" + std::to_string(file->island.value);
  if (file->suffix == ".png" || file->suffix == ".yaml")
    return grid_download(map, patches, stem, file->suffix);
  return plan_download(map, patches, stem, file->suffix);
}

}  // namespace isthmus
