#include "server/engine/sightings/map_judge.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "relations/confidence.hpp"

namespace isthmus {
namespace {

double largest_variance(const Eigen::Matrix2d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()(1);
}

// How surely the target's place is known as seen from the observer's patch, m² along the worse direction.
// Nothing where the graph near the two does not tell.
std::optional<double> target_variance(const Map& map, const Evidence& evidence, std::size_t max_patches) {
  const PatchId a = evidence.observer.pose.patch;
  const PatchId b = evidence.target_place->pose.patch;
  const auto covariance = local_relative_covariance(map.graph(), map.manifold().poses(), a, b, max_patches);
  if (!covariance) return std::nullopt;
  const Eigen::Matrix<double, 2, 3> by_pose =
      point_jacobian(map.relative_pose(a, b), position(evidence.target_place->pose.patch_from_object));
  return largest_variance(by_pose * *covariance * by_pose.transpose());
}

bool sees_walls(const Map& map, const PastPlace& place) {
  return !map.manifold().patch(place.pose.patch).points.empty();
}

double own_sigma_m(const ProjectedSighting& sighting) {
  return std::isfinite(sighting.range_sigma_m) ? sighting.range_sigma_m
                                               : sighting.bearing_sigma_rad * std::max(1.0, sighting.range_m);
}

}  // namespace

Judgement MapJudge::judge(const Map& map, const Evidence& evidence, const EngineOptions& options) {
  const PatchId a = evidence.observer.pose.patch;
  const PatchId b = evidence.target_place->pose.patch;
  if (map.graph().island(a) != map.graph().island(b)) return Judgement::unknown;
  ProjectedSighting sighting = project_sighting(map, evidence);
  const ClosureOptions& its = options.closures;
  const bool fits = agrees(sighting, Pose{}, options.alignment);
  const bool scans = sees_walls(map, evidence.observer) && sees_walls(map, *evidence.target_place);
  if (scans && fits && map.graph().hops(a, b, options.common.near_hops)) return Judgement::agrees;
  // Sightings close in time err alike: one of them tells what they all tell.
  std::int64_t& weighed_utime = weighed_utime_[{evidence.sighting.robot, evidence.target}];
  if (fits && std::abs(evidence.sighting.utime - weighed_utime) < its.weighing_us) return Judgement::agrees;
  const std::optional<double> variance = target_variance(
      map, evidence, scans ? options.surroundings.confidence_patches : its.patches_without_scans);
  if (!variance) return Judgement::unknown;
  sighting.target_variance += *variance;
  if (!agrees(sighting, Pose{}, options.alignment)) return Judgement::contradicts;
  if (std::sqrt(*variance) > (scans ? options.common.known_sigma_m : its.known_sigma_without_scans_m))
    return Judgement::unknown;
  weighed_utime = evidence.sighting.utime;
  const bool says_more = !scans && std::sqrt(*variance) > own_sigma_m(sighting);
  return says_more ? Judgement::teaches : Judgement::agrees;
}

}  // namespace isthmus
