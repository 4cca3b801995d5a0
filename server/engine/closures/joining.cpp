#include "server/engine/closures/joining.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "relations/confidence.hpp"
#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {
namespace {

bool on_one_island(const Map& map, const Joining& joining) {
  const auto size = static_cast<std::int32_t>(map.graph().patch_count());  // a trial's may be older
  return joining.first.value < size && joining.second.value < size &&
         map.graph().island(joining.first) == map.graph().island(joining.second);
}

Pose mapped(const Map& map, const Joining& joining) {
  return map.relative_pose(joining.first, joining.second);
}

std::optional<Eigen::Matrix3d> covariance(const Map& map, const Joining& joining) {
  const auto found = exact_relative_covariances(map.graph(), map.manifold().poses(), joining.first,
                                                std::span(&joining.second, 1));
  return found.empty() ? std::nullopt : std::optional(found.front());
}

/// How a joining lies to what a map says of its ends.
struct Distance {
  double chi_squared = 0;
  double log_density = 0;  ///< up to a constant
};

std::optional<Distance> distance(const Map& map, const Joining& joining, const EngineOptions& options) {
  const std::optional<Eigen::Matrix3d> known = covariance(map, joining);
  if (!known) return std::nullopt;
  Eigen::Matrix3d sum = *known + joining.covariance;
  const double alike_m = options.common.apart_m;
  const double alike_rad = options.common.yaw_rad(alike_m);
  sum.diagonal() += Eigen::Vector3d(alike_m * alike_m, alike_m * alike_m, alike_rad * alike_rad) /
                    options.trial.max_jump.bound(3);
  const Eigen::Vector3d off = wrapped_difference(mapped(map, joining), joining.first_from_second);
  const Eigen::Index size = joining.point ? 2 : 3;
  const Eigen::MatrixXd block = sum.topLeftCorner(size, size);
  const double squared = off.head(size).dot(block.inverse() * off.head(size));
  return Distance{squared, -0.5 * (squared + std::log(block.determinant()))};
}

}  // namespace

PatchId ground_of(const Map& map, PatchId patch) {
  if (map.manifold().patch(patch).tag < 0) return patch;
  const std::vector<PatchId> neighbours = map.graph().neighbours(patch);
  const auto ground =
      std::ranges::find_if(neighbours, [&](PatchId id) { return map.manifold().patch(id).tag < 0; });
  return ground == neighbours.end() ? patch : *ground;
}

Joining as_mapped(const Map& map, Joining joining) {
  if (!on_one_island(map, joining)) return joining;
  const std::optional<Eigen::Matrix3d> known = covariance(map, joining);
  if (!known) return joining;
  joining.first_from_second = mapped(map, joining);
  joining.covariance = *known;
  return joining;
}

bool brings_about(const Map& map, const Map& tried, const Joining& joining, const EngineOptions& options) {
  if (!on_one_island(tried, joining)) return false;
  const std::optional<Distance> then = distance(tried, joining, options);
  if (!then || then->chi_squared > options.trial.max_jump.bound(3)) return false;
  if (!on_one_island(map, joining)) return true;
  const std::optional<Distance> now = distance(map, joining, options);
  return !now || then->log_density > now->log_density + options.closures.tells_apart;
}

}  // namespace isthmus
