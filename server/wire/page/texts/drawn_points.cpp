#include "server/wire/page/texts/drawn_points.hpp"

#include <cmath>

namespace isthmus {

ManifoldPose manifold_pose(const path_pose_t& pose) {
  const auto& [x, y, yaw] = pose.patch_from_robot;
  return {PatchId{pose.patch}, {x, y, yaw}};
}

std::vector<ManifoldPose> thinned(const std::vector<path_pose_t>& path) {
  std::vector<ManifoldPose> poses;
  const std::size_t step = 1 + path.size() / max_drawn_poses;
  for (std::size_t i = 0; i < path.size(); i += step) poses.push_back(manifold_pose(path[i]));
  if (!path.empty() && (path.size() - 1) % step != 0) poses.push_back(manifold_pose(path.back()));
  return poses;
}

double to_centimetres(double value) { return std::isfinite(value) ? std::round(value * 1e2) / 1e2 : 0; }

}  // namespace isthmus
