#include "server/output/output.hpp"

#include "server/output/format/atomic_file.hpp"
#include "server/output/grid/grid.hpp"
#include "server/output/grid/grid_files.hpp"
#include "server/output/pictures/map_pictures.hpp"
#include "server/output/report.hpp"
#include "server/output/stale.hpp"
#include "server/output/tables/annotation_table.hpp"
#include "server/output/tables/graph_g2o.hpp"
#include "server/output/tables/islands.hpp"
#include "server/output/tables/tables.hpp"
#include "server/output/tables/trajectories.hpp"

namespace isthmus {
namespace {

void write_grids(const MapCopy& map, const RankedIslands& islands, const std::string& directory,
                 double resolution_m) {
  MapPictures pictures(map, islands, directory);
  for (std::size_t k = 0; k < islands.patches.size(); ++k) {
    const OccupancyGrid grid = render_island(map, islands.patches[k], resolution_m);
    write_grid(grid, directory + "/island-" + std::to_string(k));
    pictures.add(k, grid);
  }
  pictures.finish();
}

}  // namespace

MapCopy aligned(const MapCopy& map, const Pose& out_from_map) {
  MapCopy out = map;
  for (Pose& pose : out.poses) pose = out_from_map * pose;
  for (TagRecord& tag : out.tags) tag.position = out_from_map * tag.position;
  return out;
}

void write_outputs(const MapCopy& map, const RunCost& cost, const std::string& directory,
                   const OutputOptions& options) {
  const MapCopy out = aligned(map, options.align);
  const RankedIslands islands = rank_islands(out);
  make_directory(directory + "/trajectories");

  write_grids(out, islands, directory, options.resolution_m);
  write_trajectories(out, directory + "/trajectories");
  write_robots(out, islands, directory + "/robots.csv");
  write_patches(out, islands, directory + "/patches.csv");
  write_relations(out, directory + "/relations.csv");
  write_sightings(out, directory + "/sightings.csv");
  write_finds(out, directory + "/finds.csv");
  write_tags(out, islands, directory + "/tags.csv");
  write_annotations(out, islands, directory + "/places.geojson");
  write_g2o(out, islands, directory + "/graph.g2o");
  remove_stale(directory, islands.patches.size(), robots_of(out));
  // Last, and of the map as it is: who finds a new report finds everything it speaks of.
  write_report(map, islands, cost, directory + "/report.json");
}

}  // namespace isthmus
