#include "server/engine/map/contradicting_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/engine/map/contradiction.hpp"

namespace isthmus {

LaidOut::LaidOut(const RelationGraph& graph, std::span<const PatchPtr> patches, std::span<const Pose> poses)
    : graph_(graph), patches_(patches), poses_(poses) {
  for (const PatchPtr& patch : patches)
    if (patch->tag < 0) along_x_.emplace_back(poses[index(patch->id)].x, patch->id);
  std::ranges::sort(along_x_);
}

std::vector<PatchId> LaidOut::unrelated_around(PatchId id, const ContradictingPairsOptions& options) const {
  const Pose& here = poses_[index(id)];
  const IslandId island = graph_.island(id);
  const std::vector<PatchId> related = graph_.neighbours(id);
  const auto counts = [&](PatchId other) {
    return other != id && graph_.island(other) == island &&
           std::ranges::find(related, other) == related.end();
  };
  std::vector<std::pair<double, PatchId>> around;
  const auto first = std::ranges::lower_bound(along_x_, std::pair{here.x - options.reach_m, PatchId{0}});
  for (auto at = first; at != along_x_.end() && at->first < here.x + options.reach_m; ++at) {
    const Pose& there = poses_[index(at->second)];
    const double away_m = std::hypot(there.x - here.x, there.y - here.y);
    if (away_m < options.reach_m && counts(at->second)) around.emplace_back(away_m, at->second);
  }
  std::ranges::sort(around);
  around.resize(std::min(around.size(), options.max_compared));
  std::vector<PatchId> nearest;
  for (const auto& [away_m, other] : around) nearest.push_back(other);
  return nearest;
}

std::vector<PatchId> LaidOut::contradicted_by(PatchId id, const ContradictingPairsOptions& options) const {
  std::vector<PatchId> found;
  if (patches_[index(id)]->tag >= 0) return found;
  for (const PatchId other : unrelated_around(id, options)) {
    const std::optional<double> share =
        contradiction(*patches_[index(id)], *patches_[index(other)],
                      ominus(poses_[index(other)], poses_[index(id)]), options.contradiction);
    if (share && *share >= options.min_share) found.push_back(other);
  }
  return found;
}

}  // namespace isthmus
