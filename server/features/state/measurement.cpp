#include "server/features/state/measurement.hpp"

#include <cmath>

namespace isthmus {
namespace {

using Known = std::array<bool, 4>;

Known both(const Known& one, const Known& other, bool all) {
  Known common{};
  for (std::size_t k = 0; k < common.size(); ++k) common[k] = one[k] && other[k] && (all || k < 2);
  return common;
}

/// Of the components that `seen` knows, those that are in `common`, as rows and columns of its covariance.
LocalMatrix part_of(const LocalMatrix& covariance, const Known& known, const Known& common) {
  Known part{};
  std::size_t at = 0;
  for (std::size_t k = 0; k < known.size(); ++k)
    if (known[k]) part[at++] = common[k];
  const LocalMatrix rows = rows_of(covariance, part);
  return rows_of(LocalMatrix(rows.transpose()), part);
}

bool faces_same_side(const Feature& one, const Feature& other) {
  return point_count(one.kind) == 1 || along(one).dot(along(other)) > 0;
}

/// Of what stands at `target`, whose error of so many components begins with its position.
std::optional<LinearMeasurement> measure_polar(const FeatureState& state, const Eigen::Vector2d& target,
                                               int target_offset, int components,
                                               const RelativeSighting& sighting) {
  if (!(sighting.range_sigma_m > 0) || !(sighting.bearing_sigma_rad > 0)) return std::nullopt;
  const RobotInState& observer = state.robots[static_cast<std::size_t>(sighting.observer)];
  const Eigen::Vector2d offset = target - position(observer.map_from_robot);
  const double range = offset.norm();
  if (!(range > 1e-3)) return std::nullopt;
  Eigen::Vector2d residual(
      sighting.range_m - range,
      wrap_angle(sighting.bearing_rad - std::atan2(offset.y(), offset.x()) + observer.map_from_robot.yaw));
  Eigen::Matrix<double, 2, 3> by_target = Eigen::Matrix<double, 2, 3>::Zero();
  by_target.row(0).head<2>() = offset.transpose() / range;
  by_target.row(1).head<2>() << -offset.y() / (range * range), offset.x() / (range * range);
  Eigen::Matrix<double, 2, 3> by_observer = -by_target;
  by_observer(1, 2) = -1;
  const Eigen::Vector2d sigma(sighting.range_sigma_m, sighting.bearing_sigma_rad);
  std::vector<Eigen::Index> rows;
  for (const Eigen::Index i : {0, 1})
    if (std::isfinite(sigma(i))) rows.push_back(i);
  if (rows.empty()) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(rows.size());
  LinearMeasurement measurement;
  measurement.residual = LocalVector::Zero(count);
  measurement.noise = LocalMatrix::Zero(count, count);
  LocalMatrix of_target(count, components), of_observer(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index row = rows[static_cast<std::size_t>(i)];
    measurement.residual(i) = residual(row);
    measurement.noise(i, i) = sigma(row) * sigma(row);
    of_target.row(i) = by_target.row(row).head(components);
    of_observer.row(i) = by_observer.row(row);
  }
  measurement.blocks = {{observer.offset, of_observer}, {target_offset, of_target}};
  return measurement;
}

}  // namespace

std::optional<LinearMeasurement> measure_feature(const FeatureState& state, std::size_t index, int robot,
                                                 const ObservedFeature& seen, bool all_components) {
  const FeatureInState& entry = state.features[index];
  const RobotInState& observer = state.robots[static_cast<std::size_t>(robot)];
  if (entry.feature.kind != seen.feature.kind) return std::nullopt;
  const Pose& pose = observer.map_from_robot;
  const Feature expected = inverse(pose) * entry.feature;
  if (!is_sound(expected) || !faces_same_side(expected, seen.feature)) return std::nullopt;
  const Known known = known_components(seen.feature);
  const Known common = both(known, known_components(entry.feature), all_components);
  const LocalMatrix by_map =
      rows_of(local_jacobian(seen.feature, expected), common) * turn_of(seen.feature.kind, -pose.yaw);
  LinearMeasurement measurement;
  measurement.residual =
      rows_of(local_difference(seen.feature.kind, local_coordinates(seen.feature, seen.feature),
                               local_coordinates(seen.feature, expected)),
              common);
  measurement.noise = part_of(seen.covariance, known, common);
  measurement.blocks = {{observer.offset, -by_map * rigid_motion(entry.feature, position(pose))},
                        {entry.offset, by_map * project_to_feature(entry.feature)}};
  return measurement;
}

std::optional<LinearMeasurement> measure_robot(const FeatureState& state, const RelativeSighting& sighting) {
  const RobotInState& target = state.robots[static_cast<std::size_t>(sighting.target)];
  return measure_polar(state, position(target.map_from_robot), target.offset, 3, sighting);
}

std::optional<LinearMeasurement> measure_point(const FeatureState& state, std::size_t index,
                                               const RelativeSighting& sighting) {
  const FeatureInState& entry = state.features[index];
  return measure_polar(state, entry.feature.a, entry.offset, 2, sighting);
}

LinearMeasurement measure_relative_pose(const FeatureState& state, int one, int two, const Pose& one_from_two,
                                        const Eigen::Matrix3d& covariance) {
  const RobotInState& first = state.robots[static_cast<std::size_t>(one)];
  const RobotInState& second = state.robots[static_cast<std::size_t>(two)];
  const OminusJacobians by = ominus_jacobians(second.map_from_robot, first.map_from_robot);
  LinearMeasurement measurement;
  measurement.residual =
      wrapped_difference(one_from_two, ominus(second.map_from_robot, first.map_from_robot));
  measurement.noise = covariance;
  measurement.blocks = {{first.offset, by.by_pi}, {second.offset, by.by_q}};
  return measurement;
}

std::optional<LinearMeasurement> measure_identity(const FeatureState& state, std::size_t one,
                                                  std::size_t other, double sigma_m) {
  const FeatureInState &kept = state.features[one], &double_of = state.features[other];
  const Feature& frame = kept.feature;
  if (frame.kind != double_of.feature.kind || !faces_same_side(frame, double_of.feature)) return std::nullopt;
  const Known common = both(known_components(frame), known_components(double_of.feature), true);
  const LocalMatrix by_kept = rows_of(local_jacobian(frame, frame), common);
  const LocalMatrix by_other = rows_of(local_jacobian(frame, double_of.feature), common);
  LinearMeasurement measurement;
  measurement.residual = rows_of(local_difference(frame.kind, local_coordinates(frame, frame),
                                                  local_coordinates(frame, double_of.feature)),
                                 common);
  const Eigen::Index rows = measurement.residual.size();
  measurement.noise = sigma_m * sigma_m * LocalMatrix::Identity(rows, rows);
  measurement.blocks = {{kept.offset, -by_kept * project_to_feature(frame)},
                        {double_of.offset, by_other * project_to_feature(double_of.feature)}};
  return measurement;
}

}  // namespace isthmus
