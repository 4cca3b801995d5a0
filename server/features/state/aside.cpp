#include "server/features/state/aside.hpp"

#include <algorithm>
#include <utility>

#include "server/features/state/invariance.hpp"

namespace isthmus {
namespace {

void append_errors(std::vector<int>& errors, int offset, int count) {
  for (int k = 0; k < count; ++k) errors.push_back(offset + k);
}

/// What is told of the errors of what is aside.
Eigen::VectorXd delayed(const FeaturesAside& aside, const FeatureState& rest) {
  return aside.with_rest * rest.told;
}

}  // namespace

bool is_sound(const FeaturesAside& aside, const FeatureState& rest) {
  FeatureState alone;  // of what is aside, the robots beside it
  alone.robots = rest.robots;
  alone.features = aside.features;
  alone.next_id = rest.next_id;
  int at = static_cast<int>(aside.covariance.rows());
  for (RobotInState& robot : alone.robots) robot.offset = std::exchange(at, at + 3);
  alone.covariance.resize(at, at);
  return aside.covariance.rows() == aside.covariance.cols() && is_sound(alone) &&
         aside.with_rest.rows() == aside.covariance.rows() && aside.with_rest.cols() == rest.told.size() &&
         std::none_of(aside.features.begin(), aside.features.end(),
                      [&](const FeatureInState& entry) { return index_of(rest, entry.id).has_value(); });
}

FeaturesAside set_aside(FeatureState& state, std::span<const std::size_t> kept) {
  FeaturesAside aside;
  std::vector<FeatureInState> at_hand;
  std::vector<int> rest, others;  // errors
  for_each_pose(state, [&](RobotInState& one) {
    append_errors(rest, std::exchange(one.offset, static_cast<int>(rest.size())), 3);
    one.turned_rad = 0;
  });
  for (std::size_t i = 0; i < state.features.size(); ++i) {
    FeatureInState entry = state.features[i];
    const bool stays = std::binary_search(kept.begin(), kept.end(), i);
    std::vector<int>& errors = stays ? rest : others;
    const int offset = std::exchange(entry.offset, static_cast<int>(errors.size()));
    append_errors(errors, offset, dimension(entry.feature));
    (stays ? at_hand : aside.features).push_back(entry);
  }
  aside.covariance = state.covariance(others, others);
  aside.with_rest = state.covariance(others, rest);
  const auto size = static_cast<Eigen::Index>(rest.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2 * size, 2 * size);
  covariance.topRightCorner(size, size).setIdentity();
  covariance.bottomLeftCorner(size, size).setIdentity();
  covariance.bottomRightCorner(size, size) = state.covariance(rest, rest);
  state.covariance = std::move(covariance);
  state.told = Eigen::VectorXd::Zero(size);
  for_each_pose(state, [&](RobotInState& one) { one.offset += static_cast<int>(size); });
  for (FeatureInState& entry : at_hand) entry.offset += static_cast<int>(size);
  state.features = std::move(at_hand);
  return aside;
}

void take_back(FeatureState& state, const FeaturesAside& aside) {
  const Eigen::Index begun = state.told.size();
  const Eigen::Index near = state.covariance.rows() - begun, far = aside.covariance.rows();
  const Eigen::VectorXd delta = delayed(aside, state);
  // The first rows say by how much less the errors that the rest began with vary, P₀⁻¹ apart.
  const Eigen::MatrixXd told = -aside.with_rest * state.covariance.topLeftCorner(begun, begun);
  Eigen::MatrixXd covariance(near + far, near + far);
  covariance.topLeftCorner(near, near) = state.covariance.bottomRightCorner(near, near);
  covariance.bottomLeftCorner(far, near).noalias() =
      aside.with_rest * state.covariance.topRightCorner(begun, near);
  auto others = covariance.bottomRightCorner(far, far);
  others = aside.covariance;
  others.triangularView<Eigen::Lower>() -= told * aside.with_rest.transpose();
  covariance.triangularView<Eigen::StrictlyUpper>() = covariance.transpose();
  state.covariance = std::move(covariance);
  state.told.resize(0);
  for_each_pose(state, [&](RobotInState& one) { one.offset -= static_cast<int>(begun); });
  for (FeatureInState& entry : state.features) entry.offset -= static_cast<int>(begun);
  for (FeatureInState entry : aside.features) {
    entry.offset += static_cast<int>(near);
    state.features.push_back(entry);
  }
  std::sort(state.features.begin(), state.features.end(),
            [](const FeatureInState& a, const FeatureInState& b) { return a.id < b.id; });
  apply_delayed_correction(state, static_cast<int>(near), delta);
}

std::vector<FeatureInState> estimates(const FeaturesAside& aside, const FeatureState& rest) {
  const Eigen::VectorXd delta = delayed(aside, rest);
  std::vector<FeatureInState> now = aside.features;
  if (delta.isZero(0)) return now;
  for (FeatureInState& entry : now)
    entry.feature = delayed_estimate(rest, entry, delta.segment(entry.offset, dimension(entry.feature)));
  return now;
}

FeatureState robot_with(const FeaturesAside& aside, std::size_t index, const FeatureState& rest, int robot,
                        const Feature& as_it_is) {
  const RobotInState& own = rest.robots[static_cast<std::size_t>(robot)];
  FeatureInState entry = aside.features[index];
  const int q = dimension(entry.feature), at = entry.offset;
  FeatureState both;
  both.form = rest.form;
  both.robots = {{own.map_from_robot, 0, 0}};
  entry.feature = as_it_is;
  entry.robot = 0;
  entry.offset = 3;
  both.features = {entry};
  both.next_id = entry.id + 1;
  both.covariance.resize(3 + q, 3 + q);
  both.covariance.topLeftCorner<3, 3>() = rest.covariance.block<3, 3>(own.offset, own.offset);
  both.covariance.bottomLeftCorner(q, 3) =
      aside.with_rest.middleRows(at, q) * rest.covariance.block(0, own.offset, rest.told.size(), 3);
  both.covariance.topRightCorner(3, q) = both.covariance.bottomLeftCorner(q, 3).transpose();
  both.covariance.bottomRightCorner(q, q) = aside.covariance.block(at, at, q, q);
  return both;
}

void remove_feature(FeaturesAside& aside, std::size_t index) {
  const FeatureInState gone = aside.features[index];
  const int q = dimension(gone.feature);
  std::vector<int> left;
  append_errors(left, 0, gone.offset);
  append_errors(left, gone.offset + q, static_cast<int>(aside.covariance.rows()) - gone.offset - q);
  aside.features.erase(aside.features.begin() + static_cast<std::ptrdiff_t>(index));
  for (FeatureInState& entry : aside.features)
    if (entry.offset > gone.offset) entry.offset -= q;
  aside.covariance = aside.covariance(left, left).eval();
  aside.with_rest = aside.with_rest(left, Eigen::all).eval();
}

}  // namespace isthmus
