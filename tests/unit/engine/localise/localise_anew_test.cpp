#include <gtest/gtest.h>

#include "server/engine/localise/localise.hpp"
#include "tests/support/localised.hpp"
#include "tests/support/poses.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr std::int64_t scan_period_us = 200'000;

Match match_at(const Pose& local_from_robot, double score) {
  Match match;
  match.ok = true;
  match.local_from_robot = local_from_robot;
  match.quality.score = score;
  return match;
}

TEST(Rivals, AreElsewhereAndFitAboutAsWell) {
  const Match best = match_at({1, 2, 0}, 0.65);
  EXPECT_TRUE(rivals(best, match_at({1.6, 2, 0}, 0.62), {}));
  EXPECT_TRUE(rivals(best, match_at({1, 2, 0.3}, 0.7), {}));
  EXPECT_FALSE(rivals(best, match_at({1.1, 2, 0.1}, 0.65), {})) << "the same place";
  EXPECT_FALSE(rivals(best, match_at({3, 2, 0}, 0.28), {})) << "it does not fit there";
  Match none = match_at({3, 2, 0}, 0.65);
  none.ok = false;
  EXPECT_FALSE(rivals(best, none, {}));
}

std::optional<Placement> placed_anew(const Robot& robot, const Expectation& expectation, const LocalMap& near,
                                     const Walls& walls, const Pose& truth,
                                     const EngineOptions& options = {}) {
  const std::vector<ScanPoint> points = to_points(scan_from(walls, truth), laser_of(), {});
  return localise_anew(robot, expectation, near, points, scan_period_us, options);
}

std::optional<Placement> placed_anew(const Robot& robot, const LocalMap& near, const Walls& walls,
                                     const Pose& truth, const EngineOptions& options = {}) {
  return placed_anew(robot, expecting(robot.place->pose.patch_from_object), near, walls, truth, options);
}

// Odometry says that it stands still while it turns on the spot as fast as robots do.
TEST(LocaliseAnew, FindsTheHeadingThatOdometryMissed) {
  const Robot robot = robot_at({0.4, -0.3, 0.2});
  const Pose truth{0.45, -0.25, 0.85};
  const LocalMap near = local_map_of(furnished_room());
  const std::optional<Placement> placement = placed_anew(robot, near, furnished_room(), truth);
  ASSERT_TRUE(placement);
  EXPECT_TRUE(placement->matched);
  expect_near(placement->local_from_robot, truth, 0.02, 0.006);
}

// Odometry that lags tells of a step that the robot had made before.
TEST(LocaliseAnew, LooksWhereTheRobotWasToo) {
  const Robot robot = robot_at({0.4, -0.3, 0.2});
  const Pose truth{0.4, -0.3, 0.9};
  for (const Pose& late : {Pose{1.4, -0.3, 0.2}, Pose{0.4, 0.7, 0.2}}) {
    const std::optional<Placement> placement = placed_anew(
        robot, expecting(late, 0.2, 0.2), local_map_of(furnished_room()), furnished_room(), truth);
    ASSERT_TRUE(placement);
    expect_near(placement->local_from_robot, truth, 0.02, 0.006);
  }
}

// Somebody walks ahead through a corridor and keeps the distance: the scan is the same as before.
TEST(LocaliseAnew, BelievesOdometryRatherThanWhatMayMove) {
  const auto with_somebody_at = [](double x) {
    Walls walls = corridor();
    add_box(walls, x, -0.25, x + 0.3, 0.25);
    return walls;
  };
  Expectation expectation = expecting({0.2, 0, 0}, 0.02, 0.01);
  Robot robot = robot_at({});
  const auto placed_x = [&] {
    const std::optional<Placement> placement = placed_anew(
        robot, expectation, local_map_of(with_somebody_at(1.5)), with_somebody_at(1.7), {0.2, 0, 0});
    return placement ? placement->local_from_robot.x : 9;
  };
  EXPECT_NEAR(placed_x(), 0.2, 0.02);
  expectation.plausible = false;
  EXPECT_NEAR(placed_x(), 0, 0.05) << "unless odometry cannot be believed";
  expectation.plausible = true;
  robot.place->suspect = true;
  EXPECT_NEAR(placed_x(), 0, 0.05);
}

// Somebody walks ahead: only odometry tells where the robot is along the corridor, scan after scan.
TEST(LocaliseAnew, KnowsNoLessOfWhatOdometryAgreesWith) {
  const Robot robot = robot_at({});
  const auto with_somebody_at = [](double x) {
    Walls walls = corridor();
    add_box(walls, x, -0.25, x + 0.3, 0.25);
    return walls;
  };
  const std::optional<Placement> held =
      placed_anew(robot, expecting({0.2, 0, 0}, 0.02, 0.01), local_map_of(with_somebody_at(1.5)),
                  with_somebody_at(1.7), {0.2, 0, 0});
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->local_from_robot.x, 0.2, 0.02);
  EXPECT_LT(held->tracking_covariance(0, 0), 0.02 * 0.02 * 1.001);

  const Pose truth{0.2, 0, 0};
  const auto of_room = [&](const Pose& expected) {
    return placed_anew(robot, expecting(expected, 1e-3, 1e-3), local_map_of(furnished_room()),
                       furnished_room(), truth);
  };
  const std::optional<Placement> agreed = of_room(truth);
  ASSERT_TRUE(agreed);
  EXPECT_LT(agreed->tracking_covariance(0, 0), 1e-6 * 1.001);
  const std::optional<Placement> corrected = of_room({0.4, 0, 0});
  ASSERT_TRUE(corrected);
  EXPECT_LT(1 / corrected->tracking_covariance(0, 0), 1 / agreed->tracking_covariance(0, 0) - 0.9e6)
      << "odometry was wrong";
  EXPECT_NEAR(corrected->local_from_robot.x, truth.x, 0.02);
}

// Odometry that may be off by thirty degrees agrees with a turn of so many; looked at from where it has the
// robot, other walls seem to fit.
TEST(LocaliseAnew, StaysWhereTheScanFitsThoughOdometryAgreesLoosely) {
  const Pose truth{0.45, -0.25, 0.85};
  const std::optional<Placement> placement =
      placed_anew(robot_at({0.4, -0.3, 0.2}), expecting({0.4, -0.3, 0.2}, 0.3, 0.5),
                  local_map_of(furnished_room()), furnished_room(), truth);
  ASSERT_TRUE(placement);
  expect_near(placement->local_from_robot, truth, 0.02, 0.006);
}

// A radian and a half in a fifth of a second is none of a robot's turns, but it is after half a second
// without a match.
TEST(LocaliseAnew, SearchesAsFarAsTheRobotCanHaveTurnedSinceItWasMatched) {
  Robot robot = robot_at({0.4, -0.3, 0.2});
  const Pose truth{0.4, -0.3, 1.7};
  LocalMap near = local_map_of(furnished_room());
  near.patches.push_back({patch_from(furnished_room(), PatchId{1}, {0, 0, 2}), {0, 0, 2}});
  const std::optional<Placement> early = placed_anew(robot, near, furnished_room(), truth);
  EXPECT_TRUE(!early || std::abs(wrap_angle(early->local_from_robot.yaw - truth.yaw)) > 0.5);
  robot.place->unseen_steps = 2;
  const std::optional<Placement> placement = placed_anew(robot, near, furnished_room(), truth);
  ASSERT_TRUE(placement);
  expect_near(placement->local_from_robot, truth, 0.02, 0.006);
}

// A square room is itself after a quarter turn.
TEST(LocaliseAnew, SaysNothingWhereTwoPosesFitAboutAsWell) {
  Walls square;
  add_box(square, -3, -3, 3, 3);
  Robot robot = robot_at({});
  robot.place->unseen_steps = 10;
  EXPECT_FALSE(placed_anew(robot, local_map_of(square), square, {0, 0, 0.8}));
  EXPECT_TRUE(placed_anew(robot, local_map_of(furnished_room()), furnished_room(), {0, 0, 0.8}))
      << "any other room tells";
}

TEST(LocaliseAnew, TakesForARivalOnlyWhatFitsAboutAsWell) {
  EngineOptions options;  // any second answer of the search counts
  options.ambiguity.share = 0;
  options.correlative.second_share = 0.1;
  const Pose truth{0.45, -0.25, 1};
  const std::optional<Placement> placement = placed_anew(
      robot_at({0.4, -0.3, 0.2}), local_map_of(furnished_room()), furnished_room(), truth, options);
  ASSERT_TRUE(placement);
  expect_near(placement->local_from_robot, truth, 0.02, 0.006);
}

// A robot that was carried away sees walls that are elsewhere, and some fit well enough somewhere.
TEST(LocaliseAnew, AsksForABetterScoreAfterOdometryThatCannotBeBelieved) {
  Robot robot = robot_at({0.4, -0.3, 0.2});
  const Pose truth{0.45, -0.25, 0.85};
  const LocalMap near = local_map_of(furnished_room());
  Expectation expectation = expecting(robot.place->pose.patch_from_object);
  const auto is_found = [&](double min_score) {
    EngineOptions options;
    options.common.sure_score = min_score;
    return placed_anew(robot, expectation, near, furnished_room(), truth, options).has_value();
  };
  EXPECT_TRUE(is_found(0.99)) << "nothing speaks against odometry";
  expectation.plausible = false;
  EXPECT_FALSE(is_found(0.99));
  EXPECT_TRUE(is_found(0.5));
  expectation.plausible = true;
  robot.place->suspect = true;
  EXPECT_FALSE(is_found(0.99)) << "it jumped before, and no scan has matched since";
  EXPECT_TRUE(is_found(0.5));
}

// After three seconds without a scan much of what is seen is new, and what fits is little of it; the odds
// against odometry count that.
TEST(LocaliseAnew, AsksForNoMoreThanUsualOfWhatOutweighsOdometry) {
  const Pose truth{0.45, -0.25, 0.85};
  const auto is_found = [&](double min_score, double doubtful_score, const Expectation& expectation) {
    EngineOptions options;
    options.localise.min_score = min_score;
    options.localise.common.doubtful_score = doubtful_score;
    return placed_anew(robot_at({0.4, -0.3, 0.2}), expectation, local_map_of(furnished_room()),
                       furnished_room(), truth, options)
        .has_value();
  };
  const Expectation contradicted = expecting({0.4, -0.3, 0.2}), loose = expecting({0.4, -0.3, 0.2}, 0.3, 0.5);
  EXPECT_TRUE(is_found(0.5, 0.99, contradicted));
  EXPECT_FALSE(is_found(0.99, 0.5, contradicted));
  EXPECT_FALSE(is_found(0.5, 0.99, loose)) << "nothing was weighed";
  EXPECT_TRUE(is_found(0.99, 0.5, loose));
}

TEST(LocaliseAnew, AsksForAScoreAsUsualAfterOdometryThatCannotBeBelieved) {
  const Pose truth{0.45, -0.25, 0.85};
  Walls changed = furnished_room();
  add_box(changed, 0.8, -0.9, 1.1, -0.6);
  const auto with = [&](bool plausible, double usual_score) {
    Robot robot = robot_at({0.4, -0.3, 0.2});
    for (int i = 0; i < 1000; ++i) robot.usual_misfit.learn(usual_score, {});
    Expectation expectation = expecting(robot.place->pose.patch_from_object);
    expectation.plausible = plausible;
    return placed_anew(robot, expectation, local_map_of(furnished_room()), changed, truth);
  };
  const std::optional<Placement> believed = with(true, 1);
  ASSERT_TRUE(believed);
  const double score = believed->match.quality.score;
  ASSERT_GT(score, 0.65);
  ASSERT_LT(score, 0.95);
  EXPECT_FALSE(with(false, 1 - (1 - score) / 4));
  EXPECT_TRUE(with(false, 1 - (1 - score) / 2));
}

TEST(LocaliseAnew, SaysNothingWhereTheScanFitsNowhereOrThereIsNoneOrNoMap) {
  Walls other;
  add_box(other, -1, -1, 1, 1);
  const Robot robot = robot_at({});
  EXPECT_FALSE(placed_anew(robot, local_map_of(furnished_room()), other, {0.3, 0, 0.4}));
  EXPECT_FALSE(placed_anew(robot, local_map_of(furnished_room()), {}, {}));
  EXPECT_FALSE(placed_anew(robot, {}, furnished_room(), {}));
}

}  // namespace
}  // namespace isthmus
