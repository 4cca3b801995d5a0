#include "server/engine/places/recent_way.hpp"

#include <cmath>

namespace isthmus {

void RecentWay::add(PatchId patch, double step_m, double max_m) {
  for (double& from_newest : from_newest_m) from_newest += step_m;
  newest_first.push_front(patch);
  from_newest_m.push_front(0);
  while (from_newest_m.back() > max_m) {
    newest_first.pop_back();
    from_newest_m.pop_back();
  }
}

std::vector<std::vector<PatchId>> pieces_along(const Manifold& manifold, std::span<const PatchId> patches,
                                               const HypothesisOptions& options) {
  std::vector<std::vector<PatchId>> pieces;
  RecentWay recent;
  double since_piece_m = 0;
  for (const PatchId patch : patches) {
    double step_m = 0;
    if (!recent.newest_first.empty()) {
      const Pose moved = manifold.relative_pose(recent.newest_first.front(), patch);
      step_m = std::hypot(moved.x, moved.y);
    }
    recent.add(patch, step_m, options.max_piece_way_m);
    since_piece_m += step_m;
    if (since_piece_m < options.query_every_m || recent.length_m() < options.min_piece_way_m) continue;
    since_piece_m = 0;
    pieces.emplace_back(recent.newest_first.begin(), recent.newest_first.end());
  }
  return pieces;
}

}  // namespace isthmus
