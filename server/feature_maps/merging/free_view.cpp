#include "server/feature_maps/merging/free_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus {

FreeView view_of(const Scan& scan, const Laser& laser, const Pose& map_from_robot, std::size_t sectors) {
  constexpr float unknown = -1;
  FreeView view{map_from_robot * laser.robot_from_laser, std::vector<float>(sectors, 0)};
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const BeamKind kind = classify(scan.ranges_m[i], laser);
    if (kind == BeamKind::no_return) continue;
    const double bearing = scan.bearing0_rad + static_cast<double>(i) * scan.bearing_step_rad;
    const double turns = bearing / (2 * std::numbers::pi);
    const double share = turns - std::floor(turns);
    if (!std::isfinite(share)) continue;
    const std::size_t sector =
        std::min(sectors - 1, static_cast<std::size_t>(share * static_cast<double>(sectors)));
    float& hit = view.hit_m[sector];
    if (kind == BeamKind::ignored)
      hit = unknown;
    else if (hit == 0 || scan.ranges_m[i] < hit)
      hit = hit == unknown ? unknown : scan.ranges_m[i];
  }
  for (float& hit : view.hit_m) hit = std::max(hit, 0.0F);
  return view;
}

bool is_seen_from(const std::vector<FreeView>& views, const Pose& map_from_laser,
                  const MergingOptions& options) {
  return std::any_of(views.begin(), views.end(), [&](const FreeView& view) {
    const Eigen::Vector3d off = wrapped_difference(view.map_from_laser, map_from_laser);
    return off.head<2>().norm() < options.view_every_m && std::abs(off.z()) < options.view_every_rad;
  });
}

}  // namespace isthmus
