#include <gtest/gtest.h>

#include <algorithm>

#include "server/engine/robot/odometry_bias.hpp"
#include "server/engine/robot/odometry_noise.hpp"
#include "server/engine/robot/odometry_track.hpp"
#include "server/engine/robot/turn_error.hpp"

namespace isthmus {
namespace {

TEST(OdometryTrack, GivesTheLastSampleOfExactlyThatStamp) {
  OdometryTrack track;
  track.add(100, {1, 0, 0});
  track.add(100, {2, 0, 0});
  track.add(200, {3, 0, 0});
  EXPECT_EQ(track.at(100)->x, 2);
}

TEST(OdometryTrack, InterpolatesBetweenSamplesAlsoAcrossTheTurnOfTheAngle) {
  OdometryTrack track;
  track.add(100, {0, 0, 3.1});
  track.add(200, {1, 0, -3.1});
  const auto middle = track.at(150);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(std::abs(middle->yaw), 3.14159, 1e-3);
}

TEST(OdometryTrack, KnowsNothingYetOfAStampThatIsNewerThanAllItHeard) {
  OdometryTrack track;
  EXPECT_FALSE(track.at(100));
  track.add(100, {});
  EXPECT_FALSE(track.at(101));
}

TEST(OdometryTrack, TakesTheNewestPairWhenStampsWentBack) {
  OdometryTrack track;
  track.add(1'000'000, {1, 0, 0});
  track.add(1'200'000, {2, 0, 0});
  track.add(900'000, {3, 0, 0});
  track.add(1'100'000, {5, 0, 0});
  EXPECT_NEAR(track.at(1'000'001)->x, 4, 1e-4);
}

TEST(OdometryTrack, IsAskedByStampsThatAreLaterThanItsOwn) {
  OdometryTrack track;
  for (int i = 0; i <= 10; ++i) track.add(100'000 * i, {0.1 * i, 0, 0});
  track.set_delay_of_others(250'000);
  EXPECT_NEAR(track.at(600'000)->x, 0.35, 1e-9);
  EXPECT_NEAR(track.at_own(600'000)->x, 0.6, 1e-9);
  EXPECT_EQ(track.newest_utime(), 1'250'000);
  EXPECT_TRUE(track.at(1'250'000));
  EXPECT_FALSE(track.at(1'250'001)) << "what odometry has not told yet";
}

TEST(OdometryTrack, TellsHeadingsBackFromAStamp) {
  OdometryTrack track;
  for (int i = 0; i <= 10; ++i) track.add(100'000 * i, {0, 0, 0.1 * i});
  const std::vector<double> yaws = track.own_yaws_back_from(950'000, 150'000, 4);
  ASSERT_EQ(yaws.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(yaws[k], 0.95 - 0.15 * static_cast<double>(k), 1e-9);
  EXPECT_TRUE(track.own_yaws_back_from(1'000'001, 150'000, 2).empty()) << "newer than all";
  EXPECT_TRUE(track.own_yaws_back_from(950'000, 150'000, 8).empty()) << "older than all";
}

TEST(TurnError, GoesOnWhereErrorsFollowOneAnother) {
  TurnError error;
  EXPECT_EQ(error.expected_rad(), 0);
  for (int i = 0; i < 6; ++i) error.learn(0.2, 1e-4, {});
  EXPECT_NEAR(error.expected_rad(), 0.2, 0.01);
  for (int i = 0; i < 3; ++i) error.go_on();
  EXPECT_NEAR(error.expected_rad(), 0.2, 0.04) << "over scans that tell nothing";
}

TEST(TurnError, IsNotExpectedWhereErrorsAreAtRandom) {
  TurnError error;
  for (int i = 0; i < 40; ++i) error.learn((i % 4 < 2 ? 1 : -1) * 0.2, 0.04, {});
  EXPECT_NEAR(error.expected_rad(), 0, 0.02);
  error.learn(-0.2, 0.04, {});
  error.learn(0.2, 0.04, {});
  EXPECT_GE(error.expected_rad(), 0) << "errors that take turns are noise";
}

TEST(TurnError, OfOneScanAloneSaysNothingOfTheNext) {
  TurnError error;
  error.learn(0.3, 1e-4, {});
  EXPECT_EQ(error.expected_rad(), 0);
}

TEST(OdometryNoise, LearnsToTrustOdometryThatAgreesAndToDoubtOneThatDoesNot) {
  OdometryNoise good;
  OdometryNoise bad;
  const Pose step{0.1, 0, 0.02};
  for (int i = 0; i < 500; ++i) {
    good.learn(step, step, Eigen::Matrix2d::Identity(), {}, {});
    bad.learn(step, {0.14, i % 2 == 0 ? 0.03 : -0.03, -0.03}, Eigen::Matrix2d::Identity(), {}, {});
  }
  EXPECT_LT(good.translation_scale(), 0.7);
  EXPECT_LT(good.rotation_scale(), 0.7);
  EXPECT_GT(bad.translation_scale(), 2);
  EXPECT_GT(bad.rotation_scale(), 2);
}

TEST(OdometryNoise, LearnsNothingFromRestNorAlongADirectionThatTheMatchOnlyGuesses) {
  OdometryNoise noise;
  const double before = noise.translation_scale();
  for (int i = 0; i < 500; ++i) noise.learn({}, {0.005, 0, 0}, Eigen::Matrix2d::Identity(), {}, {});
  EXPECT_EQ(noise.translation_scale(), before);
  const Eigen::Matrix2d across_only = Eigen::Vector2d(0, 1).asDiagonal();
  for (int i = 0; i < 500; ++i) noise.learn({0.1, 0, 0}, {0.3, 0, 0}, across_only, {}, {});
  EXPECT_EQ(noise.translation_scale(), before);
}

TEST(OdometryNoise, APathThatIsFarOffIsBelievedLess) {
  OdometryNoise noise;
  const Eigen::Matrix3d summed = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
  const Eigen::Matrix3d near = noise.path_covariance({1, 0, 0}, summed, {1.005, 0, 0}, true, {});
  const Eigen::Matrix3d far = noise.path_covariance({1, 0, 0}, summed, {1.5, 0, 0}, true, {});
  EXPECT_GT(far(0, 0), 10 * near(0, 0));
  // What is off by half a metre is then no contradiction: chi² within its 95 %.
  EXPECT_LE(0.25 / far(0, 0), 7.9);
}

TEST(OdometryNoise, AWayIsBelievedAsMuchWhereOnlyTheTurnIsFarOff) {
  const Eigen::Matrix3d summed = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
  const auto of = [&](const Pose& matched) {
    return OdometryNoise{}.path_covariance({1, 0, 0}, summed, matched, false, {});
  };
  const Eigen::Matrix3d turn = of({1, 0, 1}), way = of({1.5, 0, 0}), neither = of({1, 0, 0});
  EXPECT_EQ((turn.topLeftCorner<2, 2>()), (neither.topLeftCorner<2, 2>()));
  EXPECT_GT(turn(2, 2), 10 * neither(2, 2));
  EXPECT_EQ(way(2, 2), neither(2, 2));
  EXPECT_GT(way(0, 0), 10 * neither(0, 0));
}

/// A robot whose left wheel is larger, whose turns are counted a fiftieth short, whose laser looks aside.
struct BiasedWheels {
  static constexpr double turn_per_m = 0.03;
  static constexpr double turn_share = 0.02;
  static constexpr double aside_share = -0.02;
  static constexpr double way_share = 0.03;
  static constexpr double at_one_speed = 0;
  Eigen::Matrix3d noise = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
  OdometryBias bias;

  static Pose matched(const Pose& step) {
    return {step.x * (1 + way_share), step.y + aside_share * step.x,
            step.yaw * (1 + turn_share) + turn_per_m * step.x};
  }
  void drive(int steps, const Eigen::Matrix2d& trust = Eigen::Matrix2d::Identity()) {
    for (int i = 0; i < steps; ++i) {
      const Pose step{0.1, 0, i % 10 < 2 ? 0.2 : 0};
      bias.learn(step, at_one_speed, matched(step), noise, trust, {}, {});
    }
  }
};

TEST(OdometryBias, IsNoneBeforeAnythingIsLearned) {
  EXPECT_EQ(OdometryBias().corrected({0.3, -0.1, 0.2}), (Pose{0.3, -0.1, 0.2}));
}

TEST(OdometryBias, IsLearnedFromMatchesAndTakenOutOfSteps) {
  BiasedWheels robot;
  robot.drive(2000);
  EXPECT_NEAR(robot.bias.turn_per_m(), BiasedWheels::turn_per_m, 0.002);
  EXPECT_NEAR(robot.bias.turn_share(), BiasedWheels::turn_share, 0.005);
  EXPECT_NEAR(robot.bias.aside_share(), BiasedWheels::aside_share, 0.002);
  EXPECT_NEAR(robot.bias.way_share(), BiasedWheels::way_share, 0.003);
  const Pose step{0.2, 0, 0.1};
  const Pose off = ominus(robot.bias.corrected(step), BiasedWheels::matched(step));
  EXPECT_NEAR(off.x, 0, 1e-3);
  EXPECT_NEAR(off.y, 0, 1e-3);
  EXPECT_NEAR(off.yaw, 0, 1e-3);
}

TEST(OdometryBias, IsNotLearnedAlongADirectionThatTheMatchOnlyGuesses) {
  BiasedWheels robot;
  robot.drive(2000, Eigen::Vector2d(0.5, 1).asDiagonal());
  EXPECT_EQ(robot.bias.way_share(), 0) << "a corridor does not tell how far it went";
  EXPECT_NEAR(robot.bias.aside_share(), BiasedWheels::aside_share, 0.002);
  BiasedWheels other;
  other.drive(2000, Eigen::Vector2d(1, 0.5).asDiagonal());
  EXPECT_EQ(other.bias.aside_share(), 0);
}

TEST(OdometryBias, IsHardlyMovedByASlip) {
  BiasedWheels robot;
  robot.drive(1000);
  const double before = robot.bias.turn_per_m();
  robot.bias.learn({0.1, 0, 0}, BiasedWheels::at_one_speed, {0.1, 0, 0.6}, robot.noise,
                   Eigen::Matrix2d::Identity(), {}, {});
  EXPECT_NEAR(robot.bias.turn_per_m(), before, 0.001);
}

// Paths over as much way as is remembered, each as sure as it says, are together as sure as the bias is.
TEST(OdometryBias, TurnsPathsTogetherAsFarAsItIsNotKnown) {
  const OdometryBiasOptions options;
  const Pose path{0, -2, -0.5};
  const auto variance = [&](double way_m, double turn_rad) {
    return 2 * way_m * std::pow(options.turn_per_m_sigma, 2) +
           0.5 * turn_rad * std::pow(options.share_sigma, 2);
  };
  BiasedWheels robot, unsure;
  unsure.noise *= 1e9;
  EXPECT_EQ(unsure.bias.path_yaw_variance(path, options), 0) << "of a robot that matches nothing";
  unsure.drive(100);
  EXPECT_NEAR(unsure.bias.path_yaw_variance(path, options) / variance(10, 4), 1, 0.1);
  unsure.drive(9900);
  const double kept = std::exp(-0.1 / options.memory_m - 0.04 / options.memory_rad);
  EXPECT_NEAR(unsure.bias.path_yaw_variance(path, options) / variance(0.1 / (1 - kept), 0.04 / (1 - kept)), 1,
              0.02)
      << "no more than is remembered of 1000 m";
  robot.drive(10000);
  EXPECT_LT(robot.bias.path_yaw_variance(path, options), 0.05 * unsure.bias.path_yaw_variance(path, options))
      << "once it is learned";
}

// Scans that are .3 s late see a robot set off .3 s after its odometry, and drive as far as it says from then
// on.
TEST(OdometryBias, OfWaysIsNotWhatLateScansMissAsARobotSetsOff) {
  const double delay_s = 0.3, period_s = 0.2, speed_mps = 0.5, accelerates_s = 0.6;
  const auto odometry_x = [&](double s) {
    const double accelerated_s = std::clamp(s, 0.0, accelerates_s);
    return speed_mps *
           (0.5 * accelerated_s * accelerated_s / accelerates_s + std::max(0.0, s - accelerates_s));
  };
  const auto step_at = [&](double s) { return odometry_x(s) - odometry_x(s - period_s); };
  const auto learned = [&](bool may_be_late) {
    BiasedWheels robot;
    for (double s = period_s; s < 1.3; s += period_s) {
      const double usual_s = ScanDelayOptions{}.sigma_s;
      const double farther_if_late = may_be_late ? step_at(s - usual_s) - step_at(s) : 0;
      robot.bias.learn({step_at(s), 0, 0}, farther_if_late, {step_at(s - delay_s), 0, 0}, robot.noise,
                       Eigen::Matrix2d::Identity(), {}, {});
    }
    return robot.bias.way_share();
  };
  EXPECT_LT(learned(false), -0.04);
  EXPECT_NEAR(learned(true), 0, 0.01);
}

TEST(OdometryBias, FollowsALoadThatChanges) {
  BiasedWheels robot;
  robot.drive(2000);
  for (int i = 0; i < 3000; ++i)
    robot.bias.learn({0.1, 0, 0}, BiasedWheels::at_one_speed, {0.1, 0, 0}, robot.noise,
                     Eigen::Matrix2d::Identity(), {}, {});
  EXPECT_NEAR(robot.bias.turn_per_m(), 0, 0.005);
}

}  // namespace
}  // namespace isthmus
