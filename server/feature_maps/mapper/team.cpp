#include "server/feature_maps/mapper/team.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "relations/chi_squared.hpp"
#include "server/features/state/measurement.hpp"

namespace isthmus {
namespace {

struct Common {
  std::int32_t barcode = 0;
  std::size_t in_one = 0;  ///< indices of features
  std::size_t in_two = 0;
};

std::vector<Common> common_landmarks(const Team& one, const Team& two) {
  std::vector<Common> common;
  for (const auto& [barcode, id] : one.landmarks) {
    const auto other = two.landmarks.find(barcode);
    if (other == two.landmarks.end()) continue;
    const auto in_one = index_of(one.filter.state(), id);
    const auto in_two = index_of(two.filter.state(), other->second);
    if (in_one && in_two) common.push_back({barcode, *in_one, *in_two});
  }
  return common;
}

/// one_from_two of least squared distances (Umeyama, PAMI 13, 1991, in the plane and without scale).
Pose aligned_points(const Team& one, const Team& two, std::span<const Common> common) {
  const auto& a = one.filter.state().features;
  const auto& b = two.filter.state().features;
  Eigen::Vector2d mean_a = Eigen::Vector2d::Zero(), mean_b = Eigen::Vector2d::Zero();
  for (const Common& c : common) {
    mean_a += a[c.in_one].feature.a / static_cast<double>(common.size());
    mean_b += b[c.in_two].feature.a / static_cast<double>(common.size());
  }
  double cosine = 0, sine = 0;
  for (const Common& c : common) {
    const Eigen::Vector2d p = b[c.in_two].feature.a - mean_b, q = a[c.in_one].feature.a - mean_a;
    cosine += p.dot(q);
    sine += p.x() * q.y() - p.y() * q.x();
  }
  const double yaw = std::atan2(sine, cosine);
  const Eigen::Vector2d offset = mean_a - rotate(yaw, mean_b);
  return {offset.x(), offset.y(), yaw};
}

/// That an alignment says nothing, in m and rad: what is measured then says all.
constexpr double no_prior_sigma_m = 30;
constexpr double no_prior_sigma_rad = 3;
constexpr double identity_sigma_m = 1e-3;

}  // namespace

JoinedTeams joined_at_meeting(const Team& one, PoseOwner robot_1, const Team& two, PoseOwner robot_2,
                              const RobotAlignment& alignment, const FusionOptions& options) {
  const FeatureState &first = one.filter.state(), &second = two.filter.state();
  Fusion fusion = fuse(first, robot_1, second, robot_2, alignment, options);
  JoinedTeams joined{std::move(fusion.state), {}, std::move(fusion.duplicates)};
  PoseOwner after = robot_2;
  after.which += robot_2.is_mark ? first.next_id : static_cast<int>(first.robots.size());
  joined.one_from_two =
      pose_in(joined.state, after).map_from_robot * inverse(pose_in(second, robot_2).map_from_robot);
  return joined;
}

std::optional<JoinedTeams> joined_by_twins(const Team& one, const Team& two, const Pose& one_from_two,
                                           std::span<const TwinSeed> twins, const FusionOptions& options) {
  std::optional<Fusion> fusion = fuse(one.filter.state(), two.filter.state(), one_from_two, twins, options);
  if (!fusion) return std::nullopt;
  return JoinedTeams{std::move(fusion->state), fusion->one_from_two, std::move(fusion->duplicates)};
}

std::optional<JoinedTeams> joined_by_landmarks(const Team& one, const Team& two, std::size_t min_common,
                                               double probability) {
  const std::vector<Common> common = common_landmarks(one, two);
  if (common.size() < min_common) return std::nullopt;
  const Pose maps = aligned_points(one, two, common);
  const Pose first = one.filter.state().robots[0].map_from_robot;
  const Pose second = two.filter.state().robots[0].map_from_robot;
  RobotAlignment alignment{ominus(maps * second, first), Eigen::Matrix3d::Zero()};
  alignment.covariance.diagonal() << std::pow(no_prior_sigma_m, 2), std::pow(no_prior_sigma_m, 2),
      std::pow(no_prior_sigma_rad, 2);
  JoinedTeams joined{aligned(one.filter.state(), 0, two.filter.state(), 0, alignment), {}, {}};
  const std::size_t offset = one.filter.state().features.size();
  std::vector<LinearMeasurement> identities;
  double squared = 0;
  for (const Common& c : common) {
    auto identity = measure_identity(joined.state, c.in_one, offset + c.in_two, identity_sigma_m);
    if (!identity) continue;
    Eigen::Matrix2d own = feature_covariance(one.filter.state(), c.in_one);
    own += feature_covariance(two.filter.state(), c.in_two);
    squared += identity->residual.dot(own.llt().solve(identity->residual));
    identities.push_back(*std::move(identity));
  }
  if (squared > chi2_quantile(probability, 2 * static_cast<int>(common.size()))) return std::nullopt;
  if (!correct(joined.state, identities)) return std::nullopt;
  const Pose moved = joined.state.robots[one.filter.state().robots.size()].map_from_robot;
  joined.one_from_two = moved * inverse(second);
  for (auto c = common.rbegin(); c != common.rend(); ++c) {
    const int gone = two.filter.state().features[c->in_two].id + one.filter.state().next_id;
    if (const auto index = index_of(joined.state, gone)) remove_feature(joined.state, *index);
    joined.duplicates.push_back({one.filter.state().features[c->in_one].id, gone});
  }
  return joined;
}

}  // namespace isthmus
