#include "server/output/vector_plan/map_source.hpp"

#include <algorithm>
#include <cmath>

#include "scanmatch/features/scan_features.hpp"

namespace isthmus {
namespace {

/// As many beams as tell what was looked through.
constexpr std::size_t max_beams = 361;

/// (α, ρ) of a segment at its middle: where its patch is turned by δ about the robot and shifted.
Eigen::Matrix2d line_error(const Feature& seen, const PatchErrorOptions& options) {
  const double lever = along(seen).dot(0.5 * (seen.a + seen.b));
  const Eigen::Vector2d by_turn(1, -lever);
  Eigen::Matrix2d covariance = std::pow(options.sigma_rad, 2) * by_turn * by_turn.transpose();
  covariance(1, 1) += std::pow(options.sigma_m, 2);
  return covariance;
}

/// In the island's frame, with the patch's own error.
FeatureSeen placed(const ObservedFeature& seen, const Pose& map_from_patch, int view,
                   const PatchErrorOptions& options) {
  FeatureSeen result{seen, view};
  result.observed.feature = map_from_patch * seen.feature;
  LocalMatrix& covariance = result.observed.covariance;
  if (seen.feature.kind == FeatureKind::segment) {
    covariance.topLeftCorner<2, 2>() += line_error(seen.feature, options);
    return result;
  }
  Eigen::Matrix2d turn;
  turn << std::cos(map_from_patch.yaw), -std::sin(map_from_patch.yaw), std::sin(map_from_patch.yaw),
      std::cos(map_from_patch.yaw);
  const Eigen::Matrix2d own = covariance.topLeftCorner<2, 2>();
  const double spread = std::pow(options.sigma_m, 2) + std::pow(options.sigma_rad * seen.feature.a.norm(), 2);
  covariance.topLeftCorner<2, 2>() = turn * own * turn.transpose() + spread * Eigen::Matrix2d::Identity();
  return result;
}

View view_of(const Patch& patch, const Pose& map_from_patch) {
  View view;
  view.eye = position(map_from_patch * patch.laser.robot_from_laser);
  const std::size_t step = patch.points.size() / max_beams + 1;
  for (std::size_t i = 0; i < patch.points.size(); i += step)
    if (patch.points[i].position.norm() < PointIndex::horizon_m)
      view.ends.push_back(map_from_patch * patch.points[i].position);
  return view;
}

bool is_near(const ObservedFeature& seen) {
  return std::max(seen.feature.a.norm(), seen.feature.b.norm()) < PointIndex::horizon_m;
}

}  // namespace

PlanSource plan_source(const MapCopy& map, const std::vector<PatchId>& island_patches,
                       const PatchErrorOptions& options) {
  PlanSource source;
  for (const PatchId id : island_patches) {
    if (std::ranges::binary_search(map.left_out, id)) continue;
    const auto index = static_cast<std::size_t>(id.value);
    const Patch& patch = *map.patches[index];
    const Pose& pose = map.poses[index];
    const auto view = static_cast<int>(source.views.size());
    const ScanFeatures found = find_features(patch.scan, patch.laser, {});
    for (const ScanSegment& segment : found.segments)
      if (is_near(segment.observed)) source.segments.push_back(placed(segment.observed, pose, view, options));
    for (const ObservedFeature& pole : found.poles)
      if (is_near(pole)) source.poles.push_back(placed(pole, pose, view, options));
    source.views.push_back(view_of(patch, pose));
  }
  return source;
}

}  // namespace isthmus
