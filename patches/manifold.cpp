#include "patches/manifold.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace isthmus {

void Manifold::add(PatchPtr patch, const Pose& map_from_patch) {
  if (patch->id != next_id()) throw std::logic_error("patches must be added in order of their ids");
  patches_.push_back(std::move(patch));
  poses_.push_back(map_from_patch);
}

Pose Manifold::project(const ManifoldPose& object) const {
  return pose(object.patch) * object.patch_from_object;
}

ManifoldPose Manifold::transform(const ManifoldPose& object, PatchId target) const {
  return {target, ominus(project(object), pose(target))};
}

bool Manifold::same_pose(const ManifoldPose& a, const ManifoldPose& b, double tolerance_m,
                         double tolerance_rad) const {
  const Pose difference = ominus(project(a), project(b));
  return std::hypot(difference.x, difference.y) <= tolerance_m && std::abs(difference.yaw) <= tolerance_rad &&
         overlap(a.patch, b.patch);
}

bool Manifold::overlap(PatchId a, PatchId b) const {
  const Pose a_from_b = relative_pose(a, b);
  return isthmus::overlap(patch(a).free_space, transformed(a_from_b, patch(b).free_space));
}

std::optional<ManifoldPose> Manifold::project_back(const Pose& map_from_object,
                                                   std::span<const PatchId> candidates) const {
  std::optional<PatchId> best;
  bool best_contains = false;
  double best_distance = std::numeric_limits<double>::infinity();
  for (const PatchId id : candidates) {
    const Pose& map_from_patch = pose(id);
    const double distance =
        std::hypot(map_from_object.x - map_from_patch.x, map_from_object.y - map_from_patch.y);
    if (best_contains && best_distance <= distance) continue;
    const Pose r = ominus(map_from_object, map_from_patch);
    const bool contains = distance <= footprint_m || patch(id).star.contains(position(r));
    if (best && (best_contains > contains || (best_contains == contains && best_distance <= distance)))
      continue;
    best = id;
    best_contains = contains;
    best_distance = distance;
  }
  if (!best) return std::nullopt;
  return ManifoldPose{*best, ominus(map_from_object, pose(*best))};
}

}  // namespace isthmus
