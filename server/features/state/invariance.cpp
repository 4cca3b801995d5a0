#include "server/features/state/invariance.hpp"

#include <cmath>
#include <vector>

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

/// e' = O e + D e_r of all errors after a correction by those before it, e_r some of the robots': O is
/// block-diagonal, and one but for features whose frame turns.
class Carried {
 public:
  explicit Carried(const FeatureState& state)
      : by_robots_(
            Eigen::MatrixXd::Zero(state.covariance.rows(),
                                  3 * static_cast<Eigen::Index>(state.robots.size() + state.marks.size()))) {
    for_each_pose(state, [&](const RobotInState& one) {
      for (int k = 0; k < 3; ++k) columns_.push_back(one.offset + k);
    });
  }

  /// The errors at `offset` with the heading of that robot or, after those, mark.
  void shift(int offset, std::size_t robot, const Eigen::Vector2d& by) {
    by_robots_.block<2, 1>(offset, 3 * static_cast<Eigen::Index>(robot) + 2) = quarter_turn(by);
  }

  void turn(const FeatureInState& entry, const Whole& before, const Feature& to) {
    const LocalMatrix b = project_to_local(to);
    ByPose by_robot = before.by_robot;
    by_robot.topRightCorner<2, 1>() += quarter_turn(to.a - entry.feature.a);
    by_robot.bottomRightCorner<2, 1>() += quarter_turn(to.b - entry.feature.b);
    own_.push_back({entry.offset, b * before.by_own});
    by_robots_.block(entry.offset, 3 * static_cast<Eigen::Index>(entry.robot), b.rows(), 3) = b * by_robot;
  }

  /// The covariance of e'.
  void operator()(Eigen::MatrixXd& p) const {
    std::vector<int> used, from;
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      if (by_robots_.col(static_cast<Eigen::Index>(k)).isZero(0)) continue;
      used.push_back(static_cast<int>(k));
      from.push_back(columns_[k]);
    }
    const Eigen::MatrixXd by = by_robots_(Eigen::all, used);
    const Eigen::MatrixXd columns = p(Eigen::all, from);
    for (const Own& one : own_) {
      auto part = p.middleCols(one.offset, one.by.cols());
      part = (part.lazyProduct(one.by.transpose())).eval();
    }
    p.noalias() += columns * by.transpose();
    const Eigen::MatrixXd rows = p(from, Eigen::all);
    for (const Own& one : own_) {
      auto part = p.middleRows(one.offset, one.by.rows());
      part = (one.by.lazyProduct(part)).eval();
    }
    p.noalias() += by * rows;
    p.triangularView<Eigen::StrictlyUpper>() = p.transpose();
  }

 private:
  struct Own {
    int offset = 0;
    LocalMatrix by;
  };
  std::vector<Own> own_;
  std::vector<int> columns_;   ///< errors of robots, by columns of D
  Eigen::MatrixXd by_robots_;  ///< D
};

/// A feature after the correction `own` of its errors and of its robot's heading.
Feature moved(const FeatureState& state, const FeatureInState& entry, double turn_rad,
              const LocalVector& own) {
  const Exponential by(turn_rad);
  if (point_count(entry.feature.kind) == 2) {
    // An unknown end does not slide along its wall: where it is drawn is no error, but ρ is that of the
    // middle.
    const Pose& robot = state.robots[static_cast<std::size_t>(entry.robot)].map_from_robot;
    return moved(entry.feature, by, whole_error(entry.feature, robot).by_own * own);
  }
  LocalVector e = LocalVector::Zero(3);
  e.head(own.size()) = own;
  return moved(entry.feature, by, e);
}

void carry(Carried& carried, const FeatureState& state, const FeatureInState& entry, const Feature& to) {
  const auto robot = static_cast<std::size_t>(entry.robot);
  if (point_count(entry.feature.kind) == 2)
    carried.turn(entry, whole_error(entry.feature, state.robots[robot].map_from_robot), to);
  else
    carried.shift(entry.offset, robot, to.a - entry.feature.a);
}

void apply_invariant(FeatureState& state, const Eigen::VectorXd& delta) {
  Carried carried(state);
  for (FeatureInState& entry : state.features) {
    const double turn = delta(state.robots[static_cast<std::size_t>(entry.robot)].offset + 2);
    const Feature to = moved(state, entry, turn, delta.segment(entry.offset, dimension(entry.feature)));
    carry(carried, state, entry, to);
    entry.feature = to;
  }
  std::size_t i = 0;
  for_each_pose(state, [&](RobotInState& one) {
    const Eigen::Vector3d e = delta.segment<3>(one.offset);
    const Eigen::Vector2d from = position(one.map_from_robot), to = Exponential(e.z())(from, e.head<2>());
    one.map_from_robot = {to.x(), to.y(), wrap_angle(one.map_from_robot.yaw + e.z())};
    carried.shift(one.offset, i++, to - from);
  });
  carried(state.covariance);
}

void apply_printed(FeatureState& state, const Eigen::VectorXd& delta) {
  for (FeatureInState& entry : state.features)
    entry.feature = corrected(entry.feature, delta.segment(entry.offset, dimension(entry.feature)));
  for_each_pose(state, [&](RobotInState& one) {
    const Eigen::Vector3d moved = to_vector(one.map_from_robot) + delta.segment<3>(one.offset);
    one.map_from_robot = to_pose(moved);
  });
}

}  // namespace

Feature delayed_estimate(const FeatureState& state, const FeatureInState& entry, const LocalVector& delta) {
  if (state.form == FilterForm::printed) return corrected(entry.feature, delta);
  return moved(state, entry, state.robots[static_cast<std::size_t>(entry.robot)].turned_rad, delta);
}

void apply_delayed_correction(FeatureState& state, int first, const Eigen::VectorXd& delta) {
  Carried carried(state);
  for (FeatureInState& entry : state.features) {
    if (entry.offset < first) continue;
    const Feature to =
        delayed_estimate(state, entry, delta.segment(entry.offset - first, dimension(entry.feature)));
    if (state.form == FilterForm::invariant) carry(carried, state, entry, to);
    entry.feature = to;
  }
  if (state.form == FilterForm::invariant) carried(state.covariance);
}

void apply_correction(FeatureState& state, const Eigen::VectorXd& delta) {
  state.told += delta.head(state.told.size());
  for_each_pose(state, [&](RobotInState& one) { one.turned_rad += delta(one.offset + 2); });
  if (state.form == FilterForm::invariant)
    apply_invariant(state, delta);
  else
    apply_printed(state, delta);
}

void move_map(FeatureState& state, const Pose& new_from_old) {
  const Eigen::Index size = state.covariance.rows();
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(size, size);
  const Eigen::Matrix2d axes = turn_of(FeatureKind::point, new_from_old.yaw);
  for_each_pose(state, [&](RobotInState& one) {
    one.map_from_robot = new_from_old * one.map_from_robot;
    turn.block<2, 2>(one.offset, one.offset) = axes;
  });
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
