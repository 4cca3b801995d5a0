#include "server/features/feature_filter.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "server/features/unicycle_noise.hpp"

namespace isthmus {
namespace {

ObservedFeature point_at(double x, double y, double sigma_m = 0.05) {
  return {point_feature({x, y}), sigma_m * sigma_m * LocalMatrix::Identity(2, 2)};
}

ObservedFeature wall(const Eigen::Vector2d& a, const Eigen::Vector2d& b, bool end_a, bool end_b) {
  ObservedFeature seen{segment_feature(a, b, end_a, end_b), {}};
  const int q = dimension(seen.feature);
  seen.covariance = 1e-4 * LocalMatrix::Identity(q, q);
  return seen;
}

FeatureFilter at_origin(FilterOptions options = {}) {
  FeatureFilter filter(options);
  filter.add_robot({}, Eigen::Matrix3d::Zero());
  return filter;
}

FilterOptions at_once() {
  FilterOptions options;
  options.tentative.confirm_after = 1;
  return options;
}

TEST(FeatureFilter, WhatIsSeenOnceStaysOutOfTheState) {
  FeatureFilter filter = at_origin();
  filter.observe(0, std::vector{point_at(0, 5)});
  const std::vector<ObservedFeature> clutter{point_at(3, 1)};
  EXPECT_EQ(filter.observe(0, clutter).tentative, 1U);
  for (int scan = 0; scan < 12; ++scan) filter.observe(0, {});
  EXPECT_EQ(filter.observe(0, clutter).tentative, 1U);  // forgotten: counted from one again
  EXPECT_EQ(filter.observe(0, clutter).tentative, 1U);
  EXPECT_EQ(filter.observe(0, clutter).added.size(), 1U);
  EXPECT_EQ(filter.observe(0, clutter).paired.size(), 1U);
}

TEST(FeatureFilter, ALineSeenInPartGrowsItsEndsWhenTheyAreSeen) {
  FeatureFilter filter = at_origin(at_once());
  filter.observe(0, std::vector{wall({4, -1}, {4, 1}, false, false)});
  ASSERT_EQ(filter.state().features.size(), 1U);
  EXPECT_EQ(feature_covariance(filter.state(), 0).rows(), 2);

  filter.observe(0, std::vector{wall({4, -1.5}, {4, 2}, false, false)});
  EXPECT_NEAR(filter.state().features[0].feature.a.y(), -1.5, 0.02);  // seen farther, its end not known
  EXPECT_EQ(feature_covariance(filter.state(), 0).rows(), 2);

  filter.observe(0, std::vector{wall({4, -1.5}, {4, 3}, false, true)});
  EXPECT_TRUE(filter.state().features[0].feature.end_b_known);
  EXPECT_NEAR(filter.state().features[0].feature.b.y(), 3, 1e-3);
  ASSERT_EQ(feature_covariance(filter.state(), 0).rows(), 3);
  EXPECT_NEAR(feature_covariance(filter.state(), 0)(2, 2), 1e-4, 1e-5);  // the prior says nothing

  filter.observe(0, std::vector{wall({4, -2}, {4, 3}, true, true)});
  EXPECT_EQ(feature_covariance(filter.state(), 0).rows(), 4);
  EXPECT_NEAR(filter.state().features[0].feature.a.y(), -2, 1e-3);
}

TEST(FeatureFilter, AnEndSeenShortOfTheKnownWallIsNotBelieved) {
  FeatureFilter filter = at_origin(at_once());
  filter.observe(0, std::vector{wall({4, -3}, {4, 3}, false, false)});
  filter.observe(0, std::vector{wall({4, -3}, {4, 1}, false, true)});
  EXPECT_FALSE(filter.state().features[0].feature.end_b_known);
  EXPECT_NEAR(filter.state().features[0].feature.b.y(), 3, 0.02);
}

TEST(FeatureFilter, ALineWithoutEndsStillCorrectsTheRobot) {
  FeatureFilter filter = at_origin(at_once());
  filter.observe(0, std::vector{wall({4, -1}, {4, 1}, false, false)});
  filter.move(0, {0.5, 0, 0}, Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal());
  filter.observe(0, std::vector{wall({3.3, -1}, {3.3, 1}, false, false)});  // it came 0.7 m nearer
  EXPECT_NEAR(filter.state().robots[0].map_from_robot.x, 0.7, 0.01);
  EXPECT_NEAR(pose_covariance(filter.state(), 0)(1, 1), 0.04, 0.001);  // nothing along the wall
}

TEST(FeatureFilter, AnUnknownEndStaysWhenItsRobotIsCorrectedAlongTheWall) {
  FeatureFilter filter = at_origin(at_once());
  const std::vector<ObservedFeature> both{wall({-1, 3}, {1, 3}, false, false), point_at(2, 0)};
  filter.observe(0, both);
  const Feature before = filter.state().features[0].feature;
  filter.move(0, {1, 0, 0}, Eigen::Vector3d(1, 1e-6, 1e-8).asDiagonal());
  filter.observe(0, std::vector{point_at(2, 0)});  // it did not move at all
  EXPECT_NEAR(filter.state().robots[0].map_from_robot.x, 0, 0.05);
  EXPECT_NEAR((filter.state().features[0].feature.a - before.a).norm(), 0, 1e-3);
  EXPECT_NEAR((filter.state().features[0].feature.b - before.b).norm(), 0, 1e-3);
}

TEST(FeatureFilter, WhatTheFirstScanShowsEntersTheStateAtOnce) {
  FeatureFilter filter = at_origin();
  EXPECT_EQ(filter.observe(0, std::vector{point_at(2, 0)}).added.size(), 1U);
  EXPECT_EQ(filter.observe(0, std::vector{point_at(2, 3)}).tentative, 1U);
}

TEST(FeatureFilter, WallsOnBothSidesOfADoorAreTwo) {
  FeatureFilter filter = at_origin(at_once());
  filter.observe(0, std::vector{wall({4, -3}, {4, -0.5}, false, true), wall({4, 0.5}, {4, 3}, true, false)});
  const FeatureScanOutcome outcome = filter.observe(
      0, std::vector{wall({4, -3}, {4, -0.5}, false, true), wall({4, 0.5}, {4, 3}, true, false)});
  ASSERT_EQ(outcome.paired.size(), 2U);
  EXPECT_NE(outcome.paired[0].id, outcome.paired[1].id);
  EXPECT_EQ(filter.state().features.size(), 2U);
}

TEST(FeatureFilter, AThinWallsTwoSidesAreTwoFeatures) {
  FeatureFilter filter = at_origin(at_once());
  filter.observe(0, std::vector{wall({4, -1}, {4, 1}, true, true)});
  filter.move(0, {8, 0, std::numbers::pi}, 1e-4 * Eigen::Matrix3d::Identity());
  const FeatureScanOutcome outcome = filter.observe(0, std::vector{wall({3.95, -1}, {3.95, 1}, true, true)});
  EXPECT_EQ(outcome.added.size(), 1U);
}

TEST(FeatureFilter, JointCompatibilityPairsWhereTheNearestIsWrong) {
  // The robot has slipped 0.8 m forward; posts stand 1 m apart, so that each is nearest to its neighbour.
  // Only the pairing of all three is compatible as a whole.
  for (const Pairing pairing : {Pairing::joint, Pairing::nearest}) {
    FilterOptions options = at_once();
    options.association.pairing = pairing;
    FeatureFilter filter = at_origin(options);
    filter.observe(0, std::vector{point_at(4, 2, 0.01), point_at(5, 2, 0.01), point_at(6, 2, 0.01)});
    filter.move(0, {0, 0, 0}, Eigen::Vector3d(0.4, 1e-4, 1e-6).asDiagonal());
    const FeatureScanOutcome outcome = filter.observe(
        0, std::vector{point_at(3.2, 2, 0.01), point_at(4.2, 2, 0.01), point_at(5.2, 2, 0.01)});
    const bool right = outcome.paired.size() == 3 && outcome.paired[0].id == 0 && outcome.paired[2].id == 2;
    EXPECT_EQ(right, pairing == Pairing::joint);
    EXPECT_EQ(std::abs(filter.state().robots[0].map_from_robot.x - 0.8) < 0.05, pairing == Pairing::joint);
  }
}

/// Four walls of a room, as seen from a robot in it.
std::vector<ObservedFeature> room_seen(const Pose& robot) {
  std::vector<ObservedFeature> seen;
  const Eigen::Vector2d corners[] = {{6, -4}, {6, 5}, {-5, 5}, {-5, -4}};
  for (int i = 0; i < 4; ++i) {
    seen.push_back(wall(corners[i], corners[(i + 1) % 4], true, true));
    seen.back().feature = inverse(robot) * seen.back().feature;
  }
  return seen;
}

TEST(FeatureFilter, ATurnThatErredRarelyMuchLeavesNoScanUnpaired) {
  const double sigma_rad = 0.01;
  for (const double sigmas : {2.0, 4.2, 8.0}) {
    FeatureFilter filter = at_origin(at_once());
    filter.observe(0, room_seen({}));
    filter.move(0, {}, Eigen::Vector3d(1e-8, 1e-8, sigma_rad * sigma_rad).asDiagonal());
    const Pose truth{0, 0, sigmas * sigma_rad};
    const FeatureScanOutcome outcome = filter.observe(0, room_seen(truth));
    EXPECT_EQ(outcome.paired.size(), sigmas < 5 ? 4U : 0U) << sigmas << " sigmas";
    if (sigmas < 5) {
      EXPECT_NEAR(filter.state().robots[0].map_from_robot.yaw, truth.yaw, 0.1 * truth.yaw) << sigmas;
    }
  }
}

TEST(FeatureFilter, WhatIsBeyondTheUsualGateByItselfStaysUnpaired) {
  FeatureFilter filter = at_origin(at_once());
  filter.observe(0, room_seen({}));
  filter.move(0, {}, Eigen::Vector3d(1e-8, 1e-8, 1e-4).asDiagonal());
  const std::vector<ObservedFeature> all = room_seen({0, 0, 0.042});
  const FeatureScanOutcome outcome = filter.observe(0, {all.data(), 1});
  EXPECT_TRUE(outcome.paired.empty()) << "the robot's pose can be bent to fit it, whatever it is";
  EXPECT_EQ(outcome.undecided, 1U);
}

TEST(FeatureFilter, WhatIsSeenThroughOftenEnoughGoes) {
  FeatureFilter filter = at_origin(at_once());
  filter.observe(0, std::vector{point_at(3, 0), point_at(3, 2), wall({5, -1}, {5, 1}, true, true)});
  const std::vector<ObservedFeature> still{point_at(3, 2)};
  const auto free_below = [](const Eigen::Vector2d& p) { return p.y() < 1.5 && p.x() < 4.5; };
  std::vector<int> gone;
  for (int scan = 0; scan < 6; ++scan)
    for (const int id : filter.contradict(0, filter.observe(0, still), free_below)) gone.push_back(id);
  EXPECT_EQ(gone, std::vector<int>{0});
  EXPECT_EQ(filter.state().features.size(), 2U);
}

TEST(FeatureFilter, WhatWasSeenOftenOutlivesAFewContradictions) {
  FeatureFilter filter = at_origin(at_once());
  for (int scan = 0; scan < 40; ++scan) filter.observe(0, std::vector{point_at(3, 0)});
  for (int scan = 0; scan < 10; ++scan)
    EXPECT_TRUE(
        filter.contradict(0, filter.observe(0, {}), [](const Eigen::Vector2d&) { return true; }).empty());
}

TEST(FeatureFilter, RefusesWhatIsNoFeatureAndCountsIt) {
  FeatureFilter filter = at_origin(at_once());
  const FeatureScanOutcome outcome =
      filter.observe(0, std::vector{point_at(3, 0, 0), wall({4, 1}, {4, 1}, true, true), point_at(2, 1)});
  EXPECT_EQ(outcome.unsound, 2U);
  EXPECT_EQ(outcome.added.size(), 1U);
  EXPECT_FALSE(filter.move(0, {std::nan(""), 0, 0}, Eigen::Matrix3d::Identity()));
  EXPECT_FALSE(filter.observe_robot({0, 0, 1, 0, 0, 0.1}));
}

TEST(FeatureFilter, AFullStateIsStillCorrected) {
  FilterOptions options = at_once();
  options.max_features = 2;
  FeatureFilter filter = at_origin(options);
  const std::vector<ObservedFeature> seen{point_at(3, 0), point_at(3, 2), point_at(3, -2)};
  EXPECT_EQ(filter.observe(0, seen).too_many, 1U);
  EXPECT_EQ(filter.observe(0, seen).paired.size(), 2U);
}

TEST(FeatureFilter, CornersAreToldApartByTheirAngle) {
  FeatureFilter filter = at_origin(at_once());
  const auto corner = [](double opening) {
    return ObservedFeature{corner_feature({3, 1}, 2.5, opening), 1e-4 * LocalMatrix::Identity(3, 3)};
  };
  filter.observe(0, std::vector{corner(1.57)});
  EXPECT_EQ(filter.observe(0, std::vector{corner(1.6)}).paired.size(), 1U);
  EXPECT_EQ(filter.observe(0, std::vector{corner(4.71)}).added.size(), 1U);
}

TEST(FeatureFilter, ClutterIsBounded) {
  FilterOptions options = at_once();
  options.association.max_steps = 2'000;
  FeatureFilter filter = at_origin(options);
  std::vector<ObservedFeature> many;
  for (int row = 0; row < 5; ++row)
    for (int column = 0; column < 8; ++column) many.push_back(point_at(3 + 0.05 * column, 0.05 * row, 0.05));
  filter.observe(0, many);
  filter.move(0, {}, 0.01 * Eigen::Matrix3d::Identity());
  const FeatureScanOutcome outcome = filter.observe(0, many);  // the search ends, and what it found is used
  EXPECT_GT(outcome.paired.size(), 0U);
}

/// Corners on both sides of a corridor of 60 m, each a metre, as seen within 4 m.
std::vector<ObservedFeature> corners_seen(const Pose& robot) {
  std::vector<ObservedFeature> seen;
  for (int i = 0; i < 60; ++i) {
    for (const double y : {-1.5, 1.5}) {
      const Feature corner = inverse(robot) * corner_feature({i, y}, y, 1.57);
      if (corner.a.norm() < 4) seen.push_back({corner, 1e-4 * LocalMatrix::Identity(3, 3)});
    }
  }
  return seen;
}

struct InCorridor {
  FeatureFilter filter;
  Pose truth;

  explicit InCorridor(std::size_t at_hand) : filter(at_origin(options_with(at_hand))) {}
  static FilterOptions options_with(std::size_t at_hand) {
    FilterOptions options = at_once();
    options.at_hand = at_hand;
    return options;
  }
  /// Odometry errs as its noise is.
  void drive(int steps, double yaw) {
    truth.yaw = yaw;
    for (int i = 0; i < steps; ++i) {
      truth = truth * Pose{0.5, 0, 0};
      filter.move(0, {0.5, 0, i % 2 == 0 ? 0.002 : -0.001}, Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal());
      filter.observe(0, corners_seen(truth));
    }
  }
  void turn() {
    for (int i = 0; i < 8; ++i) {
      truth.yaw += std::numbers::pi / 8;
      filter.move(0, {0, 0, std::numbers::pi / 8}, 1e-5 * Eigen::Matrix3d::Identity());
      filter.observe(0, corners_seen(truth));
    }
  }
};

TEST(FeatureFilter, WhatIsFarWaitsAndIsFoundAgainAsIfItHadBeenAtHand) {
  InCorridor part(5), all(1'000);
  for (InCorridor* corridor : {&part, &all}) corridor->drive(100, 0);
  EXPECT_EQ(all.filter.state().features.size(), all.filter.feature_count());
  EXPECT_LT(2 * part.filter.state().features.size(), part.filter.feature_count());
  for (InCorridor* corridor : {&part, &all}) {
    corridor->turn();
    corridor->drive(90, std::numbers::pi);
  }
  EXPECT_LT(2 * part.filter.state().features.size(), part.filter.feature_count());
  part.filter.gather();
  const FeatureState &one = part.filter.state(), &other = all.filter.state();
  ASSERT_EQ(one.features.size(), other.features.size());
  EXPECT_LE(one.features.size(), 120U);
  for (std::size_t i = 0; i < one.features.size(); ++i) {
    EXPECT_LT((one.features[i].feature.a - other.features[i].feature.a).norm(), 1e-4);
    EXPECT_EQ(one.features[i].seen, other.features[i].seen);
    EXPECT_TRUE(feature_covariance(one, i).isApprox(feature_covariance(other, i), 1e-3));
  }
  EXPECT_TRUE(pose_covariance(one, 0).isApprox(pose_covariance(other, 0), 1e-3));
}

TEST(FeatureFilter, WhatIsFarAndSeenThroughOftenEnoughGoes) {
  InCorridor part(5), all(1'000);
  const auto is_free = [](const Eigen::Vector2d& point) { return point.x() < -20 && point.x() > -30; };
  std::vector<std::vector<int>> gone;
  for (InCorridor* corridor : {&part, &all}) {
    corridor->drive(100, 0);
    std::vector<int>& its = gone.emplace_back();
    for (int scan = 0; scan < 50; ++scan)
      for (const int id : corridor->filter.contradict(0, {}, is_free)) its.push_back(id);
    std::sort(its.begin(), its.end());
  }
  EXPECT_EQ(gone[0], gone[1]);
  EXPECT_EQ(gone[0].size(), 20U);
  EXPECT_LT(2 * part.filter.state().features.size(), part.filter.feature_count());
  part.filter.gather();
  EXPECT_EQ(part.filter.state().features.size(), all.filter.state().features.size());
}

TEST(FeaturesAside, AreSoundOnlyBesideWhatTheyWereSetAsideOf) {
  FeatureFilter filter = at_origin(at_once());
  filter.observe(0, corners_seen({2, 0, 0}));
  FeatureState rest = filter.state();
  const FeaturesAside aside = set_aside(rest, std::vector<std::size_t>{0, 1});
  EXPECT_TRUE(is_sound(aside, rest));
  FeatureState other = filter.state();
  set_aside(other, std::vector<std::size_t>{0, 1, 2});
  EXPECT_FALSE(is_sound(aside, other)) << "of other errors";
  other = rest;
  other.features[1].id = aside.features[0].id;
  EXPECT_FALSE(is_sound(aside, other)) << "it is there twice";
  FeaturesAside cut = aside;
  cut.covariance.conservativeResize(3, 3);
  EXPECT_FALSE(is_sound(cut, rest));
}

TEST(FeatureFilter, AnotherStateLeavesNothingAside) {
  InCorridor corridor(5);
  corridor.drive(100, 0);
  corridor.filter.replace(at_origin().state());
  EXPECT_EQ(corridor.filter.feature_count(), 0U);
}

TEST(FeatureFilter, PointsAreAlwaysAtHand) {
  InCorridor corridor(5);
  const ObservedFeature tag = point_at(2, 0);
  const int none = -1;
  const std::vector<int> ids = corridor.filter.observe_known(0, {&tag, 1}, {&none, 1});
  corridor.drive(100, 0);
  EXPECT_LT(corridor.filter.state().features.size(), corridor.filter.feature_count());
  EXPECT_TRUE(index_of(corridor.filter.state(), ids.front()));
}

TEST(FeatureState, AMarkStaysWhereItsRobotStoodAndIsCorrectedWithTheMap) {
  FeatureFilter filter;
  filter.add_robot({}, 0.01 * Eigen::Matrix3d::Identity());
  const int id = filter.add_mark(0);
  filter.move(0, {1, 0, 0}, 1e-6 * Eigen::Matrix3d::Identity());
  const RobotInState& mark = pose_in(filter.state(), {id, true});
  EXPECT_EQ(mark.map_from_robot, Pose{});
  LinearMeasurement heading;  // of the robot, which tells that of the mark
  heading.residual = LocalVector::Constant(1, 0.1);
  heading.noise = LocalMatrix::Constant(1, 1, 1e-8);
  heading.blocks = {{filter.state().robots[0].offset, Eigen::RowVector3d(0, 0, 1)}};
  EXPECT_TRUE(filter.correct_by(heading));
  EXPECT_NEAR(pose_in(filter.state(), {id, true}).map_from_robot.yaw, 0.1, 1e-3);
  const int at = pose_in(filter.state(), {id, true}).offset;
  EXPECT_LT(filter.state().covariance(at + 2, at + 2), 1e-5);
  EXPECT_NEAR(filter.state().covariance(at, at), 0.01, 1e-3);
  EXPECT_TRUE(is_sound(filter.state()));
  filter.remove_mark(id + 1);  // there is none
  EXPECT_EQ(filter.state().marks.size(), 1U);
  filter.remove_mark(id);
  EXPECT_EQ(filter.state().covariance.rows(), 3);
  EXPECT_THROW(pose_in(filter.state(), {id, true}), std::out_of_range);
}

TEST(FeatureState, MarksWhoseIdsDoNotRiseAreUnsound) {
  FeatureFilter filter = at_origin();
  filter.add_mark(0);
  filter.add_mark(0);
  FeatureState state = filter.state();
  EXPECT_TRUE(is_sound(state));
  state.marks[1].id = state.marks[0].id;
  EXPECT_FALSE(is_sound(state));
  state.marks[1].id = state.next_id;
  EXPECT_FALSE(is_sound(state));
}

TEST(UnicycleNoise, IsThePapers) {
  const OdometryStep step = unicycle_step(0.4, 0.2, 0.5, {});
  EXPECT_DOUBLE_EQ(step.old_from_new.x, 0.2);
  EXPECT_DOUBLE_EQ(step.old_from_new.yaw, 0.1);
  EXPECT_DOUBLE_EQ(std::sqrt(step.covariance(0, 0)), 0.03 * 0.4 * 0.5);
  EXPECT_DOUBLE_EQ(std::sqrt(step.covariance(2, 2)), (0.05 * 0.2 + 0.0017) * 0.5);
}

}  // namespace
}  // namespace isthmus
