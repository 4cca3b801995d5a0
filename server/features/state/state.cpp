#include "server/features/state/state.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

namespace isthmus {
namespace {

constexpr double least_variance = 1e-12;  // m², rad²

/// Room for `count` more errors at `at`, with zeros.
void insert_errors(FeatureState& state, int at, int count) {
  const Eigen::Index size = state.covariance.rows();
  const Eigen::Index after = size - at;
  Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(size + count, size + count);
  larger.topLeftCorner(at, at) = state.covariance.topLeftCorner(at, at);
  larger.topRightCorner(at, after) = state.covariance.topRightCorner(at, after);
  larger.bottomLeftCorner(after, at) = state.covariance.bottomLeftCorner(after, at);
  larger.bottomRightCorner(after, after) = state.covariance.bottomRightCorner(after, after);
  state.covariance = std::move(larger);
  for_each_pose(state, [&](RobotInState& one) { one.offset += one.offset >= at ? count : 0; });
  for (FeatureInState& feature : state.features)
    if (feature.offset >= at) feature.offset += count;
}

void remove_errors(FeatureState& state, int at, int count) {
  const Eigen::Index size = state.covariance.rows() - count;
  const Eigen::Index after = size - at;
  Eigen::MatrixXd smaller(size, size);
  smaller.topLeftCorner(at, at) = state.covariance.topLeftCorner(at, at);
  smaller.topRightCorner(at, after) = state.covariance.topRightCorner(at, after);
  smaller.bottomLeftCorner(after, at) = state.covariance.bottomLeftCorner(after, at);
  smaller.bottomRightCorner(after, after) = state.covariance.bottomRightCorner(after, after);
  state.covariance = std::move(smaller);
  for_each_pose(state, [&](RobotInState& one) { one.offset -= one.offset > at ? count : 0; });
  for (FeatureInState& feature : state.features)
    if (feature.offset > at) feature.offset -= count;
}

/// The errors at `at` become change · themselves, in rows and columns.
void change_errors(Eigen::MatrixXd& covariance, int at, const LocalMatrix& change) {
  const Eigen::Index q = change.rows();
  covariance.middleRows(at, q) = (change * covariance.middleRows(at, q)).eval();
  covariance.middleCols(at, q) = (covariance.middleCols(at, q) * change.transpose()).eval();
}

void set_known(Feature& feature, std::size_t component) {
  if (feature.kind == FeatureKind::segment)
    (component == 2 ? feature.end_a_known : feature.end_b_known) = true;
  if (feature.kind == FeatureKind::corner) feature.heading_known = true;
  if (feature.kind == FeatureKind::pole) feature.radius_known = true;
}

}  // namespace

bool is_sound(const FeatureState& state) {
  std::vector<std::pair<int, int>> errors;  // where each begins, and how long it is
  for_each_pose(state, [&](const RobotInState& one) { errors.emplace_back(one.offset, 3); });
  int last_id = -1;
  for (const MarkInState& mark : state.marks) {
    if (mark.id <= last_id || mark.id >= state.next_id) return false;
    last_id = mark.id;
  }
  last_id = -1;
  for (const FeatureInState& entry : state.features) {
    if (!is_sound(entry.feature) || entry.id <= last_id || entry.robot < 0 ||
        static_cast<std::size_t>(entry.robot) >= state.robots.size())
      return false;
    last_id = entry.id;
    errors.emplace_back(entry.offset, dimension(entry.feature));
  }
  std::sort(errors.begin(), errors.end());
  auto end = static_cast<int>(state.told.size());
  for (const auto& [begin, length] : errors) {
    if (begin != end) return false;
    end += length;
  }
  return last_id < state.next_id && state.covariance.rows() == end && state.covariance.cols() == end;
}

int add_robot(FeatureState& state, const Pose& map_from_robot, const Eigen::Matrix3d& covariance) {
  const int at = static_cast<int>(state.covariance.rows());
  insert_errors(state, at, 3);
  state.covariance.block<3, 3>(at, at) = covariance;
  for (int k = 0; k < 3; ++k) {
    double& variance = state.covariance(at + k, at + k);
    variance = std::max(variance, least_variance);
  }
  state.robots.push_back({map_from_robot, at, 0});
  return static_cast<int>(state.robots.size()) - 1;
}

int add_mark(FeatureState& state, int robot) {
  RobotInState stood = state.robots[static_cast<std::size_t>(robot)];
  const int from = stood.offset, at = static_cast<int>(state.covariance.rows());
  insert_errors(state, at, 3);
  Eigen::MatrixXd& p = state.covariance;
  p.middleRows<3>(at) = p.middleRows<3>(from).eval();
  p.middleCols<3>(at) = p.middleCols<3>(from).eval();
  p.block<3, 3>(at, at).diagonal().array() += least_variance;  // two errors that are one have no inverse
  stood.offset = at;
  state.marks.push_back({state.next_id, stood});
  return state.next_id++;
}

void remove_mark(FeatureState& state, int id) {
  const auto found = std::ranges::find(state.marks, id, &MarkInState::id);
  if (found == state.marks.end()) return;
  const int at = found->stood.offset;
  state.marks.erase(found);
  remove_errors(state, at, 3);
}

const RobotInState& pose_in(const FeatureState& state, PoseOwner owner) {
  if (!owner.is_mark) return state.robots[static_cast<std::size_t>(owner.which)];
  const auto found = std::ranges::find(state.marks, owner.which, &MarkInState::id);
  if (found == state.marks.end()) throw std::out_of_range("no mark of that id");
  return found->stood;
}

void move_robot(FeatureState& state, int robot, const Pose& old_from_new, const Eigen::Matrix3d& covariance) {
  RobotInState& moved = state.robots[static_cast<std::size_t>(robot)];
  const Pose before = moved.map_from_robot;
  const Pose after = before * old_from_new;
  const int at = moved.offset;
  const Eigen::Vector2d arm = quarter_turn(position(after) - position(before));
  Eigen::MatrixXd& p = state.covariance;
  p.middleCols<2>(at) += p.col(at + 2) * arm.transpose();
  p.middleRows<2>(at) += arm * p.row(at + 2);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << std::cos(before.yaw), -std::sin(before.yaw), std::sin(before.yaw),
      std::cos(before.yaw);
  const Eigen::Matrix3d noise = turn * covariance * turn.transpose();
  p.block<3, 3>(at, at) += 0.5 * (noise + noise.transpose());
  moved.map_from_robot = after;
}

Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 4, 3> rigid_motion(const Feature& feature,
                                                               const Eigen::Vector2d& position) {
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 4, 3> by(coordinate_count(feature.kind), 3);
  by.setZero();
  by.topLeftCorner<2, 2>().setIdentity();
  by.topRightCorner<2, 1>() = quarter_turn(feature.a - position);
  if (point_count(feature.kind) == 1) return by;
  by.bottomLeftCorner<2, 2>().setIdentity();
  by.bottomRightCorner<2, 1>() = quarter_turn(feature.b - position);
  return by;
}

LocalMatrix turn_of(FeatureKind kind, double yaw_rad) {
  const int size = coordinate_count(kind);
  Eigen::Matrix2d turn;
  turn << std::cos(yaw_rad), -std::sin(yaw_rad), std::sin(yaw_rad), std::cos(yaw_rad);
  LocalMatrix by = LocalMatrix::Identity(size, size);
  by.topLeftCorner<2, 2>() = turn;
  if (point_count(kind) == 2) by.bottomRightCorner<2, 2>() = turn;
  return by;
}

int add_feature(FeatureState& state, int robot, const ObservedFeature& seen) {
  const RobotInState& observer = state.robots[static_cast<std::size_t>(robot)];
  const Pose pose = observer.map_from_robot;
  const Feature feature = pose * seen.feature;
  const LocalMatrix b = project_to_local(feature);
  const Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 4, 3> by_pose = b * rigid_motion(feature, position(pose));
  const LocalMatrix by_seen = b * turn_of(feature.kind, pose.yaw) * project_to_feature(seen.feature);
  const int at = static_cast<int>(state.covariance.rows());
  const int q = dimension(feature);
  insert_errors(state, at, q);
  Eigen::MatrixXd& p = state.covariance;
  p.block(at, 0, q, at) = by_pose * p.block(observer.offset, 0, 3, at);
  p.block(0, at, at, q) = p.block(at, 0, q, at).transpose();
  const LocalMatrix own = p.block(at, observer.offset, q, 3) * by_pose.transpose();
  const LocalMatrix noise = by_seen * seen.covariance * by_seen.transpose();
  p.block(at, at, q, q) = 0.5 * (own + own.transpose() + noise + noise.transpose());
  state.features.push_back({state.next_id, feature, robot, at, 1, 0});
  return state.next_id++;
}

void make_known(FeatureState& state, std::size_t index, std::size_t component, double sigma) {
  FeatureInState& entry = state.features[index];
  const std::array<bool, 4> known = known_components(entry.feature);
  if (known[component]) return;
  const auto before = std::count(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(component), true);
  const int own = entry.offset;
  const int at = own + static_cast<int>(before);
  insert_errors(state, at, 1);
  entry.offset = own;
  state.covariance(at, at) = sigma * sigma;
  set_known(entry.feature, component);
}

void stretch_segment(FeatureState& state, std::size_t index, double a_m, double b_m) {
  FeatureInState& entry = state.features[index];
  const Stretched longer = stretched(entry.feature, a_m, b_m);
  entry.feature = longer.feature;
  change_errors(state.covariance, entry.offset, longer.change);
}

void remove_feature(FeatureState& state, std::size_t index) {
  const FeatureInState gone = state.features[index];
  state.features.erase(state.features.begin() + static_cast<std::ptrdiff_t>(index));
  remove_errors(state, gone.offset, dimension(gone.feature));
}

std::optional<std::size_t> index_of(const FeatureState& state, int id) {
  const auto found =
      std::lower_bound(state.features.begin(), state.features.end(), id,
                       [](const FeatureInState& entry, int wanted) { return entry.id < wanted; });
  if (found == state.features.end() || found->id != id) return std::nullopt;
  return static_cast<std::size_t>(found - state.features.begin());
}

Eigen::Matrix3d pose_covariance(const FeatureState& state, int robot) {
  const int at = state.robots[static_cast<std::size_t>(robot)].offset;
  return state.covariance.block<3, 3>(at, at);
}

LocalMatrix feature_covariance(const FeatureState& state, std::size_t index) {
  const FeatureInState& entry = state.features[index];
  const int q = dimension(entry.feature);
  return state.covariance.block(entry.offset, entry.offset, q, q);
}

double pose_nees(const FeatureState& state, int robot, const Pose& truth) {
  const Pose& estimate = state.robots[static_cast<std::size_t>(robot)].map_from_robot;
  Eigen::Matrix3d covariance = pose_covariance(state, robot);
  Eigen::Vector3d error = wrapped_difference(truth, estimate);
  if (state.form == FilterForm::invariant) {
    const double turn = error.z();
    const double sine = std::abs(turn) < 1e-9 ? 1 : std::sin(turn) / turn;
    const double versine = std::abs(turn) < 1e-9 ? 0.5 * turn : (1 - std::cos(turn)) / turn;
    const Eigen::Vector2d moved = position(truth) - rotate(turn, position(estimate));
    error.head<2>() =
        Eigen::Vector2d(sine * moved.x() + versine * moved.y(), sine * moved.y() - versine * moved.x()) /
        (sine * sine + versine * versine);
    Eigen::Matrix3d to_invariant = Eigen::Matrix3d::Identity();
    to_invariant.topRightCorner<2, 1>() = -quarter_turn(position(estimate));
    covariance = (to_invariant * covariance * to_invariant.transpose()).eval();
  }
  return error.dot(covariance.llt().solve(error));
}

}  // namespace isthmus
