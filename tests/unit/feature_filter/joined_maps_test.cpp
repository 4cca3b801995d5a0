#include "server/features/fusion/joined_maps.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <numbers>
#include <random>

#include "server/features/fusion/tie.hpp"
#include "server/features/fusion/tie_filter.hpp"
#include "server/features/state/measurement.hpp"

namespace isthmus {
namespace {

Eigen::MatrixXd random_spd(std::mt19937& random, int size, double scale) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::MatrixXd root =
      Eigen::MatrixXd::NullaryExpr(size, size, [&](Eigen::Index, Eigen::Index) { return uniform(random); });
  return scale * (root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(size, size));
}

/// A robot and a feature of each kind, with errors that all hang together.
FeatureState map_of_all_kinds(std::mt19937& random, const Pose& map_from_world) {
  FeatureState state;
  add_robot(state, map_from_world * Pose{2, 1, 0.4}, 1e-2 * Eigen::Matrix3d::Identity());
  const std::vector<Feature> world{point_feature({4, 3}), segment_feature({6, -2}, {6, 2}, true, true),
                                   segment_feature({0, -3}, {5, -3}, false, true),
                                   corner_feature({-3, 2}, 0.3, 1.5), pole_feature({1, 6}, 0.2, true)};
  const Pose robot_from_map = inverse(state.robots[0].map_from_robot);
  for (const Feature& feature : world) {
    const int q = dimension(feature);
    add_feature(state, 0, {robot_from_map * (map_from_world * feature), 1e-4 * LocalMatrix::Identity(q, q)});
  }
  state.covariance += random_spd(random, static_cast<int>(state.covariance.rows()), 1e-5);
  return state;
}

/// Two maps of one place, tied by a sighting and three pairs; features 3 and 4 of the second are not paired.
struct Tied {
  std::mt19937 random{7};
  FeatureState one = map_of_all_kinds(random, {}), two = map_of_all_kinds(random, {30, -20, 2});
  RobotAlignment alignment{{0.01, -0.02, 0.003}, 1e-4 * Eigen::Matrix3d::Identity()};
  TiedMaps maps{one, two, inverse(Pose{30, -20, 2}), {2, 1}};
  TieFilter ties{one, two};
  std::vector<bool> gone{true, true, true, false, false};

  Tied() {
    EXPECT_TRUE(ties.append(tie_robots(maps, {0}, {0}, alignment)));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(ties.append(tie_features(maps, i, i, 1e-3).value()));
  }
};

/// The same by one correction of the whole aligned state, in which the place of the second map is as good as
/// unknown before.
FeatureState by_correcting_all(const Tied& tied) {
  RobotAlignment nothing{
      ominus(tied.maps.one_from_two * tied.two.robots[0].map_from_robot, tied.one.robots[0].map_from_robot),
      1e3 * Eigen::Matrix3d::Identity()};
  FeatureState joint = aligned(tied.one, 0, tied.two, 0, nothing);
  std::vector<LinearMeasurement> measurements{
      measure_relative_pose(joint, 0, 1, tied.alignment.one_from_two, tied.alignment.covariance)};
  for (std::size_t i = 0; i < 3; ++i) measurements.push_back(measure_identity(joint, i, 5 + i, 1e-3).value());
  EXPECT_TRUE(correct(joint, measurements));
  for (std::size_t i = 0; i < 3; ++i) remove_feature(joint, 5);
  return joint;
}

TEST(JoinedMaps, AreWhatCorrectingTheWholeAlignedStateGives) {
  const Tied tied;
  const FeatureState joint = joined_maps(tied.maps, tied.ties, tied.gone), expected = by_correcting_all(tied);
  ASSERT_EQ(joint.covariance.rows(), expected.covariance.rows());
  EXPECT_LT((joint.covariance - expected.covariance).norm(), 1e-4 * expected.covariance.norm());
  for (std::size_t i = 0; i < joint.robots.size(); ++i)
    EXPECT_LT(wrapped_difference(joint.robots[i].map_from_robot, expected.robots[i].map_from_robot).norm(),
              1e-5);
  for (std::size_t i = 0; i < joint.features.size(); ++i) {
    EXPECT_EQ(joint.features[i].id, expected.features[i].id);
    EXPECT_EQ(joint.features[i].offset, expected.features[i].offset);
    EXPECT_LT((coordinates(joint.features[i].feature) - coordinates(expected.features[i].feature)).norm(),
              1e-5);
  }
}

TEST(JoinedMaps, TheCovarianceIsSymmetricAndPositiveDefinite) {
  const Tied tied;
  const Eigen::MatrixXd p = joined_maps(tied.maps, tied.ties, tied.gone).covariance;
  EXPECT_EQ(p, p.transpose());
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(p).info(), Eigen::Success);
}

TEST(Tie, DerivativesAreTheNumericOnes) {
  const Tied tied;
  constexpr double step = 1e-6;
  for (std::size_t i = 0; i < 5; ++i) {
    const MapTie tie = tie_features(tied.maps, i, i, 1e-3).value();
    for (int k = 0; k < 3; ++k) {
      const auto residual = [&](double by) {
        TiedMaps moved = tied.maps;
        return tie_features(
                   TiedMaps{moved.one, moved.two, moved.moved(by * Eigen::Vector3d::Unit(k)), moved.about}, i,
                   i, 1e-3)
            ->residual;
      };
      const LocalVector numeric = (residual(-step) - residual(step)) / (2 * step);
      EXPECT_LT((numeric - tie.by_maps.col(k)).norm(), 1e-5) << name(tied.one.features[i].feature.kind) << k;
    }
  }
}

TEST(Tie, ASightingWhoseBearingErredIsHardlyContradictedByTheTruth) {
  FeatureState one, two;
  add_robot(one, {}, Eigen::Matrix3d::Zero());
  add_robot(two, {}, Eigen::Matrix3d::Zero());
  const double off_rad = 3 * 0.07;  // robot 2 is 4 m ahead, looking back
  const RobotAlignment alignment = align_robots({4, 4, off_rad, 0, 0.02, 0.02, 0.07, 0.07});
  const MapTie tie = tie_robots({one, two, {4, 0, std::numbers::pi}, {4, 0}, {0, 0}}, {0}, {0}, alignment);
  EXPECT_NEAR(tie.residual.dot(LocalMatrix(tie.noise).llt().solve(tie.residual)), 9, 1e-6);
}

TEST(TieFilter, ATieSaysLessTheMoreOthersHaveSaid) {
  Tied tied;
  const MapTie again = tie_features(tied.maps, 3, 3, 1e-3).value();
  const TieFilter before(tied.one, tied.two);
  EXPECT_LT(tied.ties.given(again).covariance.trace(), before.given(again).covariance.trace());
  EXPECT_FALSE(tied.ties.append({LocalVector::Zero(1), -LocalMatrix::Identity(1, 1), 0, 0,
                                 LocalMatrix::Zero(1, 1), LocalMatrix::Zero(1, 1), ByMaps::Zero(1, 3)}));
}

}  // namespace
}  // namespace isthmus
