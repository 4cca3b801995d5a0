#include "server/features/fusion/tie.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

using Known = std::array<bool, 4>;

Known both_know(const Feature& one, const Feature& other) {
  Known common = known_components(one);
  const Known others = known_components(other);
  for (std::size_t k = 0; k < common.size(); ++k) common[k] = common[k] && others[k];
  return common;
}

/// The common case at a fraction of the cost: two places.
MapTie tie_points(const TiedMaps& maps, const FeatureInState& kept, const FeatureInState& twin,
                  const Eigen::Vector2d& place, double sigma_m) {
  MapTie tie;
  tie.offset_one = kept.offset;
  tie.offset_two = twin.offset;
  tie.residual = kept.feature.a - place;
  tie.noise = sigma_m * sigma_m * LocalMatrix::Identity(2, 2);
  tie.by_one = -LocalMatrix::Identity(2, 2);
  tie.by_two = turn_of(FeatureKind::point, maps.one_from_two.yaw);
  tie.by_maps.resize(2, 3);
  tie.by_maps << Eigen::Matrix2d::Identity(), quarter_turn(place - maps.about);
  return tie;
}

/// Range, bearing of the second robot from the first, and of the first from the second.
Eigen::Vector3d polar(const Pose& one_from_two) {
  const Pose back = inverse(one_from_two);
  return {std::hypot(one_from_two.x, one_from_two.y), std::atan2(one_from_two.y, one_from_two.x),
          std::atan2(back.y, back.x)};
}

/// By (x, y, yaw): the inverse of the alignment's Jacobian.
Eigen::Matrix3d polar_jacobian(const Pose& one_from_two) {
  const double range = std::hypot(one_from_two.x, one_from_two.y);
  const double c = one_from_two.x / range, s = one_from_two.y / range;
  Eigen::Matrix3d by;
  by << c, s, 0, -s / range, c / range, 0, -s / range, c / range, -1;
  return by;
}

constexpr double least_range_m = 0.05;  // nearer, bearings tell nothing

}  // namespace

Pose TiedMaps::moved(const Eigen::Vector3d& delta) const {
  const Pose turned{about.x() + delta.x(), about.y() + delta.y(), wrap_angle(delta.z())};
  return turned * Pose{-about.x(), -about.y(), 0} * one_from_two;
}

MapTie tie_robots(const TiedMaps& maps, PoseOwner robot_1, PoseOwner robot_2,
                  const RobotAlignment& alignment) {
  const RobotInState& first = pose_in(maps.one, robot_1);
  const RobotInState& second = pose_in(maps.two, robot_2);
  const Pose there = maps.one_from_two * second.map_from_robot;
  const OminusJacobians by = ominus_jacobians(there, first.map_from_robot);
  const Pose expected = ominus(there, first.map_from_robot);
  MapTie tie;
  tie.offset_one = first.offset;
  tie.offset_two = second.offset;
  tie.residual = wrapped_difference(alignment.one_from_two, expected);
  tie.noise = alignment.covariance;
  Eigen::Matrix3d measured_by = Eigen::Matrix3d::Identity();
  const double nearest = std::min(polar(expected)(0), polar(alignment.one_from_two)(0));
  if (alignment.is_polar && nearest > least_range_m) {
    const Eigen::Matrix3d by_measured = polar_jacobian(alignment.one_from_two);
    Eigen::Vector3d off = polar(alignment.one_from_two) - polar(expected);
    off(1) = wrap_angle(off(1));
    off(2) = wrap_angle(off(2));
    tie.residual = off;
    tie.noise = by_measured * alignment.covariance * by_measured.transpose();
    measured_by = polar_jacobian(expected);
  }
  tie.by_one = measured_by * by.by_pi;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity(), rigid = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = turn_of(FeatureKind::point, maps.one_from_two.yaw);
  rigid.topRightCorner<2, 1>() = quarter_turn(position(there) - maps.about);
  tie.by_two = measured_by * by.by_q * turn;
  tie.by_maps = measured_by * by.by_q * rigid;
  return tie;
}

std::optional<MapTie> tie_features(const TiedMaps& maps, std::size_t in_one, std::size_t in_two,
                                   double sigma_m) {
  const FeatureInState &kept = maps.one.features[in_one], &twin = maps.two.features[in_two];
  const Feature& frame = kept.feature;
  if (frame.kind != twin.feature.kind) return std::nullopt;
  const Feature there = maps.one_from_two * twin.feature;
  if (frame.kind == FeatureKind::point) return tie_points(maps, kept, twin, there.a, sigma_m);
  if (point_count(frame.kind) == 2 && along(frame).dot(along(there)) <= 0) return std::nullopt;
  const Known common = both_know(frame, there);
  const LocalMatrix by_kept = rows_of(local_jacobian(frame, frame), common);
  const LocalMatrix by_there = rows_of(local_jacobian(frame, there), common);
  MapTie tie;
  tie.offset_one = kept.offset;
  tie.offset_two = twin.offset;
  tie.residual = rows_of(
      local_difference(frame.kind, local_coordinates(frame, frame), local_coordinates(frame, there)), common);
  tie.noise = sigma_m * sigma_m * LocalMatrix::Identity(tie.residual.size(), tie.residual.size());
  tie.by_one = -by_kept * project_to_feature(frame);
  tie.by_two = by_there * turn_of(frame.kind, maps.one_from_two.yaw) * project_to_feature(twin.feature);
  tie.by_maps = by_there * rigid_motion(there, maps.about);
  return tie;
}

}  // namespace isthmus
