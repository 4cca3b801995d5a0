#include "server/engine/map/in_view.hpp"

#include <algorithm>
#include <vector>

namespace isthmus {
namespace {

double share_of(int part, int whole) { return whole > 0 ? static_cast<double>(part) / whole : 0; }

}  // namespace

double InView::share() const { return share_of(seen + looked_through, seen + looked_through + out_of_view); }

double InView::share_seen() const { return share_of(seen, seen + looked_through); }

InView in_view(const LocalMap& local, std::span<const ScanPoint> points, const Pose& local_from_points,
               const ContradictionOptions& options) {
  std::vector<Pose> patch_from_points;
  for (const LocalPatch& patch : local.patches)
    patch_from_points.push_back(inverse(patch.local_from_patch) * local_from_points);
  const auto any_patch = [&](const ScanPoint& point, const auto& says) {
    for (std::size_t i = 0; i < local.patches.size(); ++i)
      if (says(*local.patches[i].patch, patch_from_points[i] * point.position)) return true;
    return false;
  };
  const auto sees = [](const Patch& patch, const Eigen::Vector2d& at) {
    return patch.index.nearest(at) >= 0;
  };
  const auto looks_through = [&](const Patch& patch, const Eigen::Vector2d& at) {
    return patch.star.depth_m(at) > options.deep_m;
  };
  InView view;
  for (const ScanPoint& point : points) {
    if (any_patch(point, sees))
      ++view.seen;
    else if (any_patch(point, looks_through))
      ++view.looked_through;
    else
      ++view.out_of_view;
  }
  return view;
}

}  // namespace isthmus
