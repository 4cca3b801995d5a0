#include "server/output/vector_plan/plan_files.hpp"

#include "server/output/format/atomic_file.hpp"
#include "server/output/tables/islands.hpp"
#include "server/output/vector_plan/map_source.hpp"

namespace isthmus {
namespace {

void write(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace

void write_plan_files(const VectorPlan& plan, std::size_t island, const std::string& directory) {
  const std::string name = "island-" + std::to_string(island);
  const std::string frame = "x and y in metres, in the frame of " + name;
  write(directory + "/" + name + "-plan.svg", plan_svg(plan));
  write(directory + "/" + name + "-plan.dxf", plan_dxf(plan, frame));
  write(directory + "/" + name + "-plan.geojson", plan_geojson(plan, frame));
}

void write_plans(const MapCopy& map, const std::string& directory, const PlanOptions& options) {
  const RankedIslands islands = rank_islands(map);
  for (std::size_t k = 0; k < islands.patches.size(); ++k)
    write_plan_files(fit_plan(plan_source(map, islands.patches[k], options.patch_error), options), k,
                     directory);
}

}  // namespace isthmus
