#pragma once

#include <Eigen/Core>
#include <optional>
#include <tuple>
#include <vector>

#include "patches/features/m_space.hpp"
#include "server/features/options.hpp"

namespace isthmus {

struct RobotInState {
  Pose map_from_robot;
  int offset = 0;         ///< of its error (x, y, yaw) in the state's
  double turned_rad = 0;  ///< by corrections since features were set aside

  auto members() { return std::tie(map_from_robot, offset, turned_rad); }
};

/// Where a robot stood once, and how that erred: what was measured there can be used later.
struct MarkInState {
  int id = 0;
  RobotInState stood;

  auto members() { return std::tie(id, stood); }
};

struct FeatureInState {
  int id = 0;
  Feature feature;  ///< in the map's frame
  int robot = 0;    ///< index of the robot that made it
  int offset = 0;   ///< of its error x_p, dimension(feature) long
  int seen = 1;
  int contradicted = 0;

  auto members() { return std::tie(id, feature, robot, offset, seen, contradicted); }
};

/// J: a quarter turn to the left.
inline Eigen::Vector2d quarter_turn(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

/// Poses of robots and features in one frame, with one joint covariance: what one filter knows. A value.
///
/// Errors e are those of the standard EKF: truth less estimate in the map's axes (m, rad), of a feature B
/// times that. Along a direction in which a feature is not known it is taken to move with the robot that made
/// it. The invariant form's errors ξ are e = ξ + J l̂ ξ_θ for a position l̂, J a quarter turn, ξ_θ that of the
/// robot which made it (Barrau and Bonnabel); at a given estimate one is linear in the other, so the
/// covariance of e serves both forms, if it is carried over to the new estimate after each correction
/// (server/features/state/correction.hpp).
struct FeatureState {
  FilterForm form = FilterForm::invariant;
  std::vector<RobotInState> robots;
  std::vector<FeatureInState> features;  ///< by id
  Eigen::MatrixXd covariance;            ///< symmetric positive definite, after the first told.size() rows
  int next_id = 0;
  /// Where features are set aside (server/features/state/aside.hpp), how far the errors that the rest had
  /// then were corrected since, times the inverse of their covariance. These come first in `covariance`:
  /// their rows have how today's errors follow from those and, among themselves, the information that was
  /// gained of them, negative. Empty where all is in the state.
  Eigen::VectorXd told = {};
  std::vector<MarkInState> marks = {};  ///< by id, one sequence with the features'
};

/// All robots' poses, then those of the marks.
template <class State, class Use>
void for_each_pose(State& state, const Use& use) {
  for (auto& robot : state.robots) use(robot);
  for (auto& mark : state.marks) use(mark.stood);
}

/// Whose pose: a robot's, by index, or a mark's, by id.
struct PoseOwner {
  int which = 0;
  bool is_mark = false;
};
/// Throws std::out_of_range where there is no such mark.
const RobotInState& pose_in(const FeatureState& state, PoseOwner owner);

/// Whether it is one: errors side by side in one covariance, features by rising id and each made by a robot.
bool is_sound(const FeatureState& state);

/// A robot unrelated to the others; returns its index. Variances below 1e-12 are raised to it, so that the
/// first robot, whose pose is the frame, keeps the covariance positive definite.
int add_robot(FeatureState& state, const Pose& map_from_robot, const Eigen::Matrix3d& covariance);

/// A mark where the robot stands now, which errs as it does now; returns its id.
int add_mark(FeatureState& state, int robot);
/// Nothing where there is none of that id.
void remove_mark(FeatureState& state, int id);

/// Odometry: the robot moves on by old_from_new, whose (x, y, yaw) err with `covariance`, independently of
/// all else.
void move_robot(FeatureState& state, int robot, const Pose& old_from_new, const Eigen::Matrix3d& covariance);

/// A feature as the robot sees it, new to the state; returns its id.
int add_feature(FeatureState& state, int robot, const ObservedFeature& seen);

/// Makes an end, heading or radius known, with a prior of `sigma` (m or rad) and no correlation: what is
/// measured next determines it. `component` as in known_components; nothing where it is known already.
void make_known(FeatureState& state, std::size_t index, std::size_t component, double sigma);

/// Moves the unknown ends of a segment along its line, to a_m and b_m from its middle.
void stretch_segment(FeatureState& state, std::size_t index, double a_m, double b_m);

void remove_feature(FeatureState& state, std::size_t index);

/// Index of the feature of an id.
std::optional<std::size_t> index_of(const FeatureState& state, int id);

Eigen::Matrix3d pose_covariance(const FeatureState& state, int robot);
LocalMatrix feature_covariance(const FeatureState& state, std::size_t index);

/// The squared error of a robot's pose over its covariance, in the errors of the state's form (x, y, yaw of
/// the difference, or the logarithm's first-order ξ): 3 on average where the filter is consistent.
double pose_nees(const FeatureState& state, int robot, const Pose& truth);

/// How a feature's x_f moves with the robot at `position` (x, y, yaw), as a rigid whole: coordinate_count by
/// 3; a pole's radius does not.
Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 4, 3> rigid_motion(const Feature& feature,
                                                               const Eigen::Vector2d& position);

/// Turns each point of x_f: coordinate_count square.
LocalMatrix turn_of(FeatureKind kind, double yaw_rad);

}  // namespace isthmus
