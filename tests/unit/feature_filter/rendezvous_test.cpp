#include "server/features/fusion/rendezvous.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "server/features/feature_filter.hpp"
#include "server/features/state/invariance.hpp"

namespace isthmus {
namespace {

/// What two robots measure that stand so, exactly.
MutualSighting sighting_of(const Pose& one_from_two, double range_sigma_m, double bearing_sigma_rad) {
  const Pose two_from_one = inverse(one_from_two);
  const double range = std::hypot(one_from_two.x, one_from_two.y);
  return {range,
          range,
          std::atan2(one_from_two.y, one_from_two.x),
          std::atan2(two_from_one.y, two_from_one.x),
          range_sigma_m,
          range_sigma_m,
          bearing_sigma_rad,
          bearing_sigma_rad};
}

ObservedFeature seen_point(double x, double y) {
  return {point_feature({x, y}), 4e-4 * LocalMatrix::Identity(2, 2)};
}
ObservedFeature seen_wall(const Eigen::Vector2d& a, const Eigen::Vector2d& b, bool end_a, bool end_b) {
  const Feature wall = segment_feature(a, b, end_a, end_b);
  return {wall, 4e-4 * LocalMatrix::Identity(dimension(wall), dimension(wall))};
}

/// A map of a few metres' drive with points and wholly known walls (or only partly known ones).
FeatureState small_map(const Pose& start, bool whole) {
  FilterOptions options;
  options.tentative.confirm_after = 1;
  FeatureFilter filter(options);
  filter.add_robot(start, Eigen::Vector3d(1e-4, 2e-4, 1e-5).asDiagonal());
  filter.observe(0, std::vector{seen_point(4, 1), seen_wall({5, -1}, {5, 2}, whole, whole)});
  filter.move(0, {1, 0.1, 0.3}, Eigen::Vector3d(4e-4, 1e-4, 1e-4).asDiagonal());
  filter.observe(0, std::vector{seen_point(6, -2), seen_wall({3, 2}, {0, 2.5}, true, whole)});
  return filter.state();
}

const Pose between_robots{2.5, 1.2, 2.9};

/// Coordinates of a whole state: poses, then x_f.
Eigen::VectorXd coordinates_of(const FeatureState& state) {
  Eigen::VectorXd all(0);
  const auto add = [&](const Eigen::VectorXd& part) {
    all.conservativeResize(all.size() + part.size());
    all.tail(part.size()) = part;
  };
  for (const RobotInState& robot : state.robots) add(to_vector(robot.map_from_robot));
  for (const FeatureInState& entry : state.features) add(coordinates(entry.feature));
  return all;
}

FeatureState with_coordinates_of(FeatureState state, const Eigen::VectorXd& all) {
  Eigen::Index at = 0;
  for (RobotInState& robot : state.robots) {
    robot.map_from_robot = to_pose(all.segment<3>(at));
    at += 3;
  }
  for (FeatureInState& entry : state.features) {
    const int size = coordinate_count(entry.feature.kind);
    entry.feature = with_coordinates(entry.feature, all.segment(at, size));
    at += size;
  }
  return state;
}

/// D or, with `tilde`, D̃: identity for poses, B or B̃ for features.
Eigen::MatrixXd projections(const FeatureState& state, bool tilde) {
  const Eigen::Index rows = coordinates_of(state).size(), errors = state.covariance.rows();
  Eigen::MatrixXd d = tilde ? Eigen::MatrixXd::Zero(rows, errors) : Eigen::MatrixXd::Zero(errors, rows);
  Eigen::Index at = 0;
  const auto put = [&](Eigen::Index error, const Eigen::MatrixXd& block) {
    const Eigen::Index row = tilde ? at : error, column = tilde ? error : at;
    d.block(row, column, block.rows(), block.cols()) = block;
    at += tilde ? block.rows() : block.cols();
  };
  for (const RobotInState& robot : state.robots) put(robot.offset, Eigen::Matrix3d::Identity());
  for (const FeatureInState& entry : state.features)
    put(entry.offset, tilde ? Eigen::MatrixXd(project_to_feature(entry.feature))
                            : Eigen::MatrixXd(project_to_local(entry.feature)));
  return d;
}

/// t(¹x₁, ²x₂, z) of Benedettelli et al. 2012, eq. 15: the second map in the first's frame.
Eigen::VectorXd transform(const FeatureState& one, const FeatureState& two, const Eigen::Vector3d& z) {
  const Pose one_from_two{z(0) * std::cos(z(1)), z(0) * std::sin(z(1)), std::numbers::pi + z(1) - z(2)};
  FeatureState moved = two;
  move_map(moved, one.robots[0].map_from_robot * one_from_two * inverse(two.robots[0].map_from_robot));
  return coordinates_of(moved);
}

/// Three steps (eqs. 17 to 26), T and Γ by numeric derivatives.
Eigen::MatrixXd covariance_in_three_steps(const FeatureState& one, const FeatureState& two,
                                          const Eigen::Vector3d& z, const Eigen::Matrix3d& r_z,
                                          const FeatureState& result) {
  const Eigen::VectorXd x1 = coordinates_of(one), x2 = coordinates_of(two);
  const Eigen::MatrixXd d1 = projections(one, true), d2 = projections(two, true);
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(x1.size() + x2.size(), x1.size() + x2.size());
  p.topLeftCorner(x1.size(), x1.size()) = d1 * one.covariance * d1.transpose();
  p.bottomRightCorner(x2.size(), x2.size()) = d2 * two.covariance * d2.transpose();
  Eigen::MatrixXd t = Eigen::MatrixXd::Identity(p.rows(), p.cols());
  t.bottomRightCorner(x2.size(), x2.size()).setZero();
  constexpr double step = 1e-6;
  for (Eigen::Index k = 0; k < p.rows(); ++k) {
    const bool first = k < x1.size();
    const Eigen::VectorXd by =
        step * Eigen::VectorXd::Unit(first ? x1.size() : x2.size(), first ? k : k - x1.size());
    const auto at = [&](double sign) {
      return first ? transform(with_coordinates_of(one, x1 + sign * by), two, z)
                   : transform(one, with_coordinates_of(two, x2 + sign * by), z);
    };
    t.col(k).tail(x2.size()) = (at(1) - at(-1)) / (2 * step);
  }
  Eigen::MatrixXd gamma = Eigen::MatrixXd::Zero(p.rows(), 3);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d by = step * Eigen::Vector3d::Unit(k);
    gamma.col(k).tail(x2.size()) = (transform(one, two, z + by) - transform(one, two, z - by)) / (2 * step);
  }
  const Eigen::MatrixXd p_a = t * p * t.transpose() + gamma * r_z * gamma.transpose();
  // Errors of the joint state come robots and features of the one map first, then those of the other.
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(result.covariance.rows(), p.rows());
  FeatureState second = result;
  second.robots.erase(second.robots.begin());
  second.features.erase(second.features.begin(),
                        second.features.begin() + static_cast<std::ptrdiff_t>(one.features.size()));
  const Eigen::Index before = one.covariance.rows();
  for (RobotInState& robot : second.robots) robot.offset -= static_cast<int>(before);
  for (FeatureInState& entry : second.features) entry.offset -= static_cast<int>(before);
  second.covariance.resize(result.covariance.rows() - before, result.covariance.rows() - before);
  d.topLeftCorner(before, x1.size()) = projections(one, false);
  d.bottomRightCorner(second.covariance.rows(), x2.size()) = projections(second, false);
  return d * p_a * d.transpose();
}

TEST(Rendezvous, TwoRobotsFindOneAnotherInClosedForm) {
  for (const double yaw : {-3.0, -0.4, 0.0, 1.7, 3.1}) {
    const Pose truth{3, -1.5, yaw};
    const RobotAlignment found = align_robots(sighting_of(truth, 0.02, 0.07));
    EXPECT_NEAR(wrapped_difference(found.one_from_two, truth).norm(), 0, 1e-12);
  }
}

TEST(Rendezvous, TheBetterRangeCountsForMore) {
  MutualSighting sighting = sighting_of({2, 0, 3}, 0.1, 0.01);
  sighting.range_1_m = 2.5;
  sighting.range_1_sigma_m = 0.2;
  const RobotAlignment found = align_robots(sighting);
  EXPECT_NEAR(found.one_from_two.x, 2.1, 1e-12);
  EXPECT_NEAR(found.covariance(0, 0), 0.008, 1e-12);
}

TEST(Rendezvous, ASigmaOfZeroIsRefused) {
  MutualSighting sighting = sighting_of({2, 0, 3}, 0.1, 0.01);
  sighting.bearing_2_sigma_rad = 0;
  EXPECT_THROW(align_robots(sighting), std::invalid_argument);
}

TEST(Rendezvous, TheCovarianceIsThatOfTheThreeStepsThroughTheFeatureSpace) {
  for (const bool whole : {true, false}) {
    const FeatureState one = small_map({0, 0, 0}, whole), two = small_map({7, -3, 1.1}, whole);
    const MutualSighting sighting = sighting_of(between_robots, 0.02, 0.07);
    const FeatureState joint = aligned(one, 0, two, 0, align_robots(sighting));
    const Eigen::Vector3d z(sighting.range_1_m, sighting.bearing_1_rad, sighting.bearing_2_rad);
    const Eigen::Matrix3d r_z = Eigen::Vector3d(0.02 * 0.02 / 2, 0.07 * 0.07, 0.07 * 0.07).asDiagonal();
    const Eigen::MatrixXd steps = covariance_in_three_steps(one, two, z, r_z, joint);
    if (whole) {
      EXPECT_LT((joint.covariance - steps).norm(), 1e-6 * steps.norm());
    } else {  // the three steps leave out how unknown ends move, which B then drops
      EXPECT_LT((joint.covariance - steps).norm(), 1e-6 * steps.norm());
    }
  }
}

TEST(Rendezvous, TenThousandDrawsErrAsTheCovarianceSays) {
  const FeatureState one = small_map({0, 0, 0}, true), two = small_map({7, -3, 1.1}, true);
  const RobotAlignment alignment = align_robots(sighting_of(between_robots, 0.02, 0.01));
  const FeatureState truth = aligned(one, 0, two, 0, alignment);
  const Eigen::LLT<Eigen::MatrixXd> joint(truth.covariance);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto draw = [&](const Eigen::MatrixXd& covariance) -> Eigen::VectorXd {
    const Eigen::VectorXd unit =
        Eigen::VectorXd::NullaryExpr(covariance.rows(), [&](Eigen::Index) { return normal(random); });
    return covariance.llt().matrixL() * unit;
  };
  const auto shifted = [&](FeatureState state) {
    state.form = FilterForm::printed;
    apply_correction(state, draw(state.covariance));
    return state;
  };
  constexpr int draws = 10'000;
  double sum = 0;
  for (int i = 0; i < draws; ++i) {
    MutualSighting sighting = sighting_of(between_robots, 0.02, 0.01);
    sighting.range_1_m += 0.02 * normal(random);
    sighting.range_2_m += 0.02 * normal(random);
    sighting.bearing_1_rad += 0.01 * normal(random);
    sighting.bearing_2_rad += 0.01 * normal(random);
    const FeatureState found = aligned(shifted(one), 0, shifted(two), 0, align_robots(sighting));
    Eigen::VectorXd error(truth.covariance.rows());
    for (std::size_t r = 0; r < 2; ++r)
      error.segment<3>(truth.robots[r].offset) =
          wrapped_difference(found.robots[r].map_from_robot, truth.robots[r].map_from_robot);
    for (std::size_t f = 0; f < truth.features.size(); ++f) {
      const FeatureInState& entry = truth.features[f];
      error.segment(entry.offset, dimension(entry.feature)) =
          project_to_local(entry.feature) *
          (coordinates(found.features[f].feature) - coordinates(entry.feature));
    }
    sum += error.dot(joint.solve(error));
  }
  EXPECT_NEAR(sum / draws / static_cast<double>(truth.covariance.rows()), 1, 0.03);
}

}  // namespace
}  // namespace isthmus
