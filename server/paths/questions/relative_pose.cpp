#include "server/paths/questions/relative_pose.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "relations/confidence.hpp"
#include "relations/mount_survey.hpp"

namespace isthmus {
namespace {

constexpr double farthest_m = 1e4;  // from a patch's origin
/// On larger islands the covariance is a bound, from the patches nearest to either.
constexpr std::size_t max_exact_patches = 5000;

/// What a relation alone leaves open of b's position in a, as a variance; large where it says little.
double variance_m2(const MapCopy& map, const Relation& relation) {
  const Pose a_from_b = ominus(map.poses[index(relation.b)], map.poses[index(relation.a)]);
  constexpr double weak = 1e-4;  // of a direction of which it says nothing: 100 m
  const Eigen::Matrix3d known = information(relation, a_from_b) + weak * Eigen::Matrix3d::Identity();
  return known.inverse().topLeftCorner<2, 2>().trace();
}

std::vector<RelationId> strongest_chain(const MapCopy& map, PatchId from, PatchId to) {
  using Entry = std::pair<double, PatchId>;
  std::vector<double> variance(map.patches.size(), std::numeric_limits<double>::infinity());
  std::vector<RelationId> by(map.patches.size());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  variance[index(from)] = 0;
  waiting.emplace(0.0, from);
  while (!waiting.empty() && waiting.top().second != to) {
    const auto [so_far, patch] = waiting.top();
    waiting.pop();
    if (so_far > variance[index(patch)]) continue;
    for (const RelationId id : map.graph.of(patch)) {
      const Relation& relation = *map.graph.find(id);
      const PatchId other = relation.a == patch ? relation.b : relation.a;
      const double then = so_far + variance_m2(map, relation);
      if (!(then < variance[index(other)])) continue;
      variance[index(other)] = then;
      by[index(other)] = id;
      waiting.emplace(then, other);
    }
  }
  std::vector<RelationId> chain;
  for (PatchId at = to; at != from;) {
    chain.push_back(by[index(at)]);
    const Relation& relation = *map.graph.find(chain.back());
    at = relation.a == at ? relation.b : relation.a;
  }
  std::reverse(chain.begin(), chain.end());
  return chain;
}

std::optional<Eigen::Matrix3d> covariance_between(const MapCopy& map, PatchId a, PatchId b) {
  if (map.graph.patches_of(map.graph.island(a)).size() > max_exact_patches)
    return local_relative_covariance(map.graph, map.poses, a, b, max_exact_patches);
  const std::array others{b};
  const auto exact = exact_relative_covariances(map.graph, map.poses, a, others);
  if (exact.empty() || !exact.front().allFinite()) return std::nullopt;
  return exact.front();
}

}  // namespace

Refusal check(const MapCopy& map, const ManifoldPose& pose) {
  const Pose& r = pose.patch_from_object;
  if (!is_finite(r) || std::hypot(r.x, r.y) > farthest_m) return Refusal::bad_value;
  if (!pose.patch.valid() || index(pose.patch) >= map.patches.size()) return Refusal::unknown_patch;
  const bool left_out = std::binary_search(map.left_out.begin(), map.left_out.end(), pose.patch);
  return left_out ? Refusal::unknown_patch : Refusal::none;
}

RelativePoseAnswer relative_pose(const MapCopy& map, const PlacedObject& a, const PlacedObject& b) {
  RelativePoseAnswer answer;
  for (const PlacedObject* object : {&a, &b}) {
    answer.refusal = object->covariance.allFinite() ? check(map, object->pose) : Refusal::bad_value;
    if (answer.refusal != Refusal::none) return answer;
  }
  const PatchId patch_a = a.pose.patch, patch_b = b.pose.patch;
  answer.refusal = Refusal::other_island;
  if (map.graph.island(patch_a) != map.graph.island(patch_b)) return answer;
  const auto between = covariance_between(map, patch_a, patch_b);
  answer.refusal = between ? Refusal::none : Refusal::undetermined;
  if (!between) return answer;
  const Pose a_from_b = ominus(map.poses[index(patch_b)], map.poses[index(patch_a)]);
  const Pose patch_from_b = a_from_b * b.pose.patch_from_object;
  const ComposeJacobians composed = compose_jacobians(a_from_b, b.pose.patch_from_object);
  const OminusJacobians seen = ominus_jacobians(patch_from_b, a.pose.patch_from_object);
  const auto carried = [](const Eigen::Matrix3d& by, const Eigen::Matrix3d& covariance) {
    return Eigen::Matrix3d(by * covariance * by.transpose());
  };
  answer.a_from_b = ominus(patch_from_b, a.pose.patch_from_object);
  answer.covariance = carried(seen.by_pi, a.covariance) + carried(seen.by_q * composed.by_left, *between) +
                      carried(seen.by_q * composed.by_right, b.covariance) +
                      mount_covariance(answer.a_from_b, a.robot, b.robot);
  answer.chain = strongest_chain(map, patch_a, patch_b);
  return answer;
}

}  // namespace isthmus
