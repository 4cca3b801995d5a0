#include "server/features/fusion/rendezvous.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace isthmus {
namespace {

/// n by 3.
using ErrorsByPose = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// e₂' = change · e₂ + by_two · e_r₂ + by_one · e_r₁ + by_alignment · e_A; `change` is block-diagonal and
/// kept as those.
struct Mapping {
  ErrorsByPose by_one, by_two, by_alignment;
};

/// What moves, and how, from the second map into the first.
struct Motion {
  Pose one;           ///< of robot 1 in its map
  Pose two;           ///< of robot 2 in its map, before
  Pose one_from_two;  ///< between the robots
  Pose new_from_old() const { return one * one_from_two * inverse(two); }
  /// Robot 2 in the new map: what the alignment's error moves all about.
  Pose two_after() const { return one * one_from_two; }
};

/// [1, J(q − p)] of a pose at q as moved by one at p; heading with heading.
Eigen::Matrix3d rigid_pose(const Pose& moved, const Pose& by) {
  Eigen::Matrix3d rigid = Eigen::Matrix3d::Identity();
  rigid(0, 2) = by.y - moved.y;
  rigid(1, 2) = moved.x - by.x;
  return rigid;
}

Eigen::Matrix3d turn3(double yaw_rad) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = turn_of(FeatureKind::point, yaw_rad);
  return turn;
}

/// The errors of the second state turned into the new axes, each by itself.
void turn_columns(Eigen::MatrixXd& x, const FeatureState& before, const FeatureState& after, double yaw_rad) {
  for_each_pose(before, [&](const RobotInState& one) {
    x.middleCols<3>(one.offset) = (x.middleCols<3>(one.offset) * turn3(yaw_rad).transpose()).eval();
  });
  for (std::size_t i = 0; i < before.features.size(); ++i) {
    const FeatureInState& entry = before.features[i];
    const LocalMatrix change = project_to_local(after.features[i].feature) *
                               turn_of(entry.feature.kind, yaw_rad) * project_to_feature(entry.feature);
    auto own = x.middleCols(entry.offset, change.rows());
    own = (own * change.transpose()).eval();
  }
}

FeatureState moved_estimate(const FeatureState& state, const Pose& new_from_old) {
  FeatureState moved = state;
  for_each_pose(moved, [&](RobotInState& one) { one.map_from_robot = new_from_old * one.map_from_robot; });
  for (FeatureInState& entry : moved.features) entry.feature = new_from_old * entry.feature;
  return moved;
}

Mapping mapping(const FeatureState& before, const FeatureState& after, const Motion& motion) {
  const Eigen::Index size = before.covariance.rows();
  Mapping map{ErrorsByPose::Zero(size, 3), ErrorsByPose::Zero(size, 3), ErrorsByPose::Zero(size, 3)};
  const Pose at_two = motion.two_after();
  const Eigen::Matrix3d turn_one = turn3(motion.one.yaw), turn = turn3(motion.new_from_old().yaw);
  for_each_pose(after, [&](const RobotInState& one) {
    map.by_one.middleRows<3>(one.offset) = rigid_pose(one.map_from_robot, motion.one);
    map.by_alignment.middleRows<3>(one.offset) = rigid_pose(one.map_from_robot, at_two) * turn_one;
    map.by_two.middleRows<3>(one.offset) = -rigid_pose(one.map_from_robot, at_two) * turn;
  });
  for (const FeatureInState& entry : after.features) {
    const LocalMatrix b = project_to_local(entry.feature);
    const Eigen::Index q = b.rows();
    const ErrorsByPose about_two = b * rigid_motion(entry.feature, position(at_two));
    map.by_one.middleRows(entry.offset, q) = b * rigid_motion(entry.feature, position(motion.one));
    map.by_alignment.middleRows(entry.offset, q) = about_two * turn_one;
    map.by_two.middleRows(entry.offset, q) = -about_two * turn;
  }
  return map;
}

void append(FeatureState& joint, const FeatureState& two) {
  const int offset = static_cast<int>(joint.covariance.rows());
  const int robots = static_cast<int>(joint.robots.size());
  for (RobotInState robot : two.robots) {
    robot.offset += offset;
    joint.robots.push_back(robot);
  }
  for (MarkInState mark : two.marks) {
    mark.id += joint.next_id;
    mark.stood.offset += offset;
    joint.marks.push_back(mark);
  }
  for (FeatureInState entry : two.features) {
    entry.offset += offset;
    entry.robot += robots;
    entry.id += joint.next_id;
    joint.features.push_back(entry);
  }
  joint.next_id += two.next_id;
}

}  // namespace

RobotAlignment align_robots(const MutualSighting& sighting) {
  const MutualSighting& s = sighting;
  const bool positive = s.range_1_m > 0 && s.range_2_m > 0 && s.range_1_sigma_m > 0 &&
                        s.range_2_sigma_m > 0 && s.bearing_1_sigma_rad > 0 && s.bearing_2_sigma_rad > 0;
  if (!positive) throw std::invalid_argument("a mutual sighting needs positive ranges and sigmas");
  const double weight_1 = 1 / (s.range_1_sigma_m * s.range_1_sigma_m);
  const double weight_2 = 1 / (s.range_2_sigma_m * s.range_2_sigma_m);
  const double range = (weight_1 * s.range_1_m + weight_2 * s.range_2_m) / (weight_1 + weight_2);
  const Eigen::Vector2d ray(std::cos(s.bearing_1_rad), std::sin(s.bearing_1_rad));
  RobotAlignment alignment;
  alignment.one_from_two = {range * ray.x(), range * ray.y(),
                            wrap_angle(std::numbers::pi + s.bearing_1_rad - s.bearing_2_rad)};
  Eigen::Matrix3d by;  // by range and both bearings
  by << ray.x(), -range * ray.y(), 0, ray.y(), range * ray.x(), 0, 0, 1, -1;
  const Eigen::Vector3d variances(1 / (weight_1 + weight_2), std::pow(s.bearing_1_sigma_rad, 2),
                                  std::pow(s.bearing_2_sigma_rad, 2));
  alignment.covariance = by * variances.asDiagonal() * by.transpose();
  alignment.is_polar = true;
  return alignment;
}

FeatureState aligned(const FeatureState& one, int robot_1, const FeatureState& two, int robot_2,
                     const RobotAlignment& alignment) {
  const RobotInState& first = one.robots[static_cast<std::size_t>(robot_1)];
  const RobotInState& second = two.robots[static_cast<std::size_t>(robot_2)];
  const Motion motion{first.map_from_robot, second.map_from_robot, alignment.one_from_two};
  const double yaw = motion.new_from_old().yaw;
  const FeatureState after = moved_estimate(two, motion.new_from_old());
  const Mapping map = mapping(two, after, motion);

  Eigen::MatrixXd own = two.covariance;
  turn_columns(own, two, after, yaw);
  const ErrorsByPose with_robot = own.middleRows<3>(second.offset).transpose();  // C P₂(:, r₂)
  own.transposeInPlace();
  turn_columns(own, two, after, yaw);
  const ErrorsByPose half =
      with_robot + 0.5 * map.by_two * two.covariance.block<3, 3>(second.offset, second.offset);
  own += half * map.by_two.transpose() + map.by_two * half.transpose();
  own += map.by_one * pose_covariance(one, robot_1) * map.by_one.transpose();
  own += map.by_alignment * alignment.covariance * map.by_alignment.transpose();

  FeatureState joint = one;
  append(joint, after);
  const Eigen::Index size = one.covariance.rows(), more = own.rows();
  joint.covariance.resize(size + more, size + more);
  joint.covariance.topLeftCorner(size, size) = one.covariance;
  joint.covariance.bottomRightCorner(more, more) = 0.5 * (own + own.transpose());
  joint.covariance.bottomLeftCorner(more, size) = map.by_one * one.covariance.middleRows<3>(first.offset);
  joint.covariance.topRightCorner(size, more) = joint.covariance.bottomLeftCorner(more, size).transpose();
  return joint;
}

}  // namespace isthmus
