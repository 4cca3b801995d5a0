#include "server/engine/propagation/layers_job.hpp"

#include <span>
#include <utility>

#include "server/engine/map/contradicting_pairs.hpp"

namespace isthmus {
namespace {

// Each pair is met from either side.
int contradicting_pairs(const RelationGraph& graph, std::span<const PatchPtr> patches,
                        std::span<const Pose> poses, std::span<const PatchId> island) {
  const LaidOut laid_out(graph, patches, poses);
  std::size_t ends = 0;
  for (const PatchId id : island) ends += laid_out.contradicted_by(id, {}).size();
  return static_cast<int>(ends / 2);
}

}  // namespace

LayersJob::LayersJob(const Map& map, IslandId island, RelationGraph graph_before,
                     std::vector<Pose> poses_before, std::int64_t now_utime, const MapFitOptions& options)
    : due_utime_(now_utime + std::ranges::ssize(map.graph().patches_of(island)) * options.us_per_patch) {
  pairs_ = std::async(std::launch::async, [map, island, graph_before = std::move(graph_before),
                                           poses_before = std::move(poses_before)] {
    const std::vector<PatchId> patches = map.graph().patches_of(island);
    const std::span<const PatchPtr> all = map.manifold().patches();
    return Pairs{contradicting_pairs(graph_before, all, poses_before, patches),
                 contradicting_pairs(map.graph(), all, map.manifold().poses(), patches)};
  });
}

}  // namespace isthmus
