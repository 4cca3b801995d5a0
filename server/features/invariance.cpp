#include "server/features/invariance.hpp"

#include <cmath>

namespace isthmus {
namespace {

using ByPose = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 4, 3>;

/// exp(ξ) of SE(2) acting on positions: R(θ) l + V(θ) ξ_l (Barrau and Bonnabel, eq. 9).
class Exponential {
 public:
  explicit Exponential(double turn_rad) : turn_rad_(turn_rad) {
    const bool small = std::abs(turn_rad) < 1e-6;
    sine_ = small ? 1 - turn_rad * turn_rad / 6 : std::sin(turn_rad) / turn_rad;
    versine_ = small ? 0.5 * turn_rad : (1 - std::cos(turn_rad)) / turn_rad;
  }

  /// A position whose standard error is e.
  Eigen::Vector2d operator()(const Eigen::Vector2d& point, const Eigen::Vector2d& e) const {
    const Eigen::Vector2d xi = e - turn_rad_ * quarter_turn(point);
    return rotate(turn_rad_, point) + sine_ * xi + versine_ * quarter_turn(xi);
  }

 private:
  double turn_rad_, sine_, versine_;
};

/// e_f of a feature by its own errors and those of the robot that made it.
struct Whole {
  LocalMatrix by_own;
  ByPose by_robot;
};
Whole whole_error(const Feature& feature, const Pose& robot) {
  const LocalMatrix b_tilde = project_to_feature(feature);
  const ByPose rigid = rigid_motion(feature, position(robot));
  const LocalMatrix known = b_tilde * project_to_local(feature);
  return {b_tilde, rigid - known * rigid};
}

Feature moved(const Feature& feature, const Exponential& by, const LocalVector& e) {
  Feature result = feature;
  result.a = by(feature.a, e.head<2>());
  if (point_count(feature.kind) == 2) result.b = by(feature.b, e.tail<2>());
  if (feature.kind == FeatureKind::corner) result.b = result.a + along(result);
  if (feature.kind == FeatureKind::pole) result.radius_m = std::max(0.0, feature.radius_m + e(2));
  return result;
}

/// e' = own · e_f + robot · e_r: a feature's errors after a correction by those before it.
struct Carried {
  LocalMatrix own;
  ByPose robot;
};
Carried carry(const Whole& before, const Feature& from, const Feature& to) {
  const LocalMatrix b = project_to_local(to);
  ByPose shift = ByPose::Zero(before.by_robot.rows(), 3);
  shift.topRightCorner<2, 1>() = quarter_turn(to.a - from.a);
  if (point_count(from.kind) == 2) shift.bottomRightCorner<2, 1>() = quarter_turn(to.b - from.b);
  return {b * before.by_own, b * (before.by_robot + shift)};
}

/// X Mᵀ: each feature's columns by its own and its robot's, then each robot's by its heading's.
void carry_columns(Eigen::MatrixXd& x, const FeatureState& state, const std::vector<Carried>& features,
                   const std::vector<Eigen::Vector2d>& robot_shifts) {
  for (std::size_t i = 0; i < features.size(); ++i) {
    const FeatureInState& entry = state.features[i];
    const int robot = state.robots[static_cast<std::size_t>(entry.robot)].offset;
    auto own = x.middleCols(entry.offset, features[i].own.cols());
    own = (own * features[i].own.transpose() + x.middleCols<3>(robot) * features[i].robot.transpose()).eval();
  }
  for (std::size_t i = 0; i < robot_shifts.size(); ++i) {
    const int at = state.robots[i].offset;
    x.middleCols<2>(at) += x.col(at + 2) * quarter_turn(robot_shifts[i]).transpose();
  }
}

void apply_invariant(FeatureState& state, const Eigen::VectorXd& delta) {
  std::vector<Carried> carried;
  carried.reserve(state.features.size());
  for (FeatureInState& entry : state.features) {
    const RobotInState& robot = state.robots[static_cast<std::size_t>(entry.robot)];
    const Eigen::Vector3d of_robot = delta.segment<3>(robot.offset);
    const Whole whole = whole_error(entry.feature, robot.map_from_robot);
    // An unknown end does not slide along its wall: where it is drawn is no error, but ρ is that of the
    // middle.
    const LocalVector e = whole.by_own * delta.segment(entry.offset, dimension(entry.feature));
    const Feature to = moved(entry.feature, Exponential(of_robot.z()), e);
    carried.push_back(carry(whole, entry.feature, to));
    entry.feature = to;
  }
  std::vector<Eigen::Vector2d> shifts;
  for (RobotInState& robot : state.robots) {
    const Eigen::Vector3d e = delta.segment<3>(robot.offset);
    const Eigen::Vector2d from = position(robot.map_from_robot), to = Exponential(e.z())(from, e.head<2>());
    robot.map_from_robot = {to.x(), to.y(), wrap_angle(robot.map_from_robot.yaw + e.z())};
    shifts.push_back(to - from);
  }
  carry_columns(state.covariance, state, carried, shifts);
  state.covariance.transposeInPlace();
  carry_columns(state.covariance, state, carried, shifts);
  state.covariance = (0.5 * (state.covariance + state.covariance.transpose())).eval();
}

void apply_printed(FeatureState& state, const Eigen::VectorXd& delta) {
  for (FeatureInState& entry : state.features)
    entry.feature = corrected(entry.feature, delta.segment(entry.offset, dimension(entry.feature)));
  for (RobotInState& robot : state.robots) {
    const Eigen::Vector3d moved = to_vector(robot.map_from_robot) + delta.segment<3>(robot.offset);
    robot.map_from_robot = to_pose(moved);
  }
}

}  // namespace

void apply_correction(FeatureState& state, const Eigen::VectorXd& delta) {
  if (state.form == FilterForm::invariant)
    apply_invariant(state, delta);
  else
    apply_printed(state, delta);
}

void move_map(FeatureState& state, const Pose& new_from_old) {
  const Eigen::Index size = state.covariance.rows();
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(size, size);
  const Eigen::Matrix2d axes = turn_of(FeatureKind::point, new_from_old.yaw);
  for (RobotInState& robot : state.robots) {
    robot.map_from_robot = new_from_old * robot.map_from_robot;
    turn.block<2, 2>(robot.offset, robot.offset) = axes;
  }
  for (FeatureInState& entry : state.features) {
    const Feature to = new_from_old * entry.feature;
    const int q = dimension(to);
    turn.block(entry.offset, entry.offset, q, q) =
        project_to_local(to) * turn_of(to.kind, new_from_old.yaw) * project_to_feature(entry.feature);
    entry.feature = to;
  }
  state.covariance = turn * state.covariance * turn.transpose();
}

}  // namespace isthmus
