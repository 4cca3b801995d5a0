#include "server/engine/localise/localise.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/support/localised.hpp"
#include "tests/support/poses.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

Placement placed(const Robot& robot, const Expectation& expectation, const LocalMap& local_map,
                 const Walls& walls, const Pose& truth, const EngineOptions& options = {}) {
  const std::vector<ScanPoint> points = to_points(scan_from(walls, truth), laser_of(), {});
  return localise(robot, expectation, local_map, points, options);
}

void expect_as_expected(const Placement& placement, const Expectation& expectation) {
  EXPECT_FALSE(placement.matched);
  expect_near(placement.local_from_robot, expectation.local_from_robot);
  EXPECT_EQ(placement.covariance, expectation.covariance);
  EXPECT_EQ(placement.tracking_covariance, expectation.tracking_covariance);
}

TEST(Place, FindsTheTruthWhereOdometryIsOff) {
  const Pose truth{0.4, -0.3, 0.2};
  const Placement placement = placed(robot_at({}), expecting({0.52, -0.38, 0.25}),
                                     local_map_of(furnished_room()), furnished_room(), truth);
  ASSERT_TRUE(placement.matched) << word(placement.reason);
  expect_near(placement.local_from_robot, truth, 0.02, 0.006);
  EXPECT_TRUE(placement.reason == Unmatched::no);
}

// Eq. 13 with what odometry expects: across the corridor the walls decide, along it nothing but odometry.
TEST(Place, BelievesOdometryWhereWallsSayNothing) {
  const Expectation expectation = expecting({0.3, 0.1, 0.02});
  const Placement placement =
      placed(robot_at({}), expectation, local_map_of(corridor()), corridor(), {0, 0, 0});
  ASSERT_TRUE(placement.matched) << word(placement.reason);
  expect_near(placement.local_from_robot, {0.3, 0, 0}, 0.02, 0.006);
  EXPECT_NEAR(placement.tracking_covariance(0, 0) / expectation.tracking_covariance(0, 0), 1, 0.05);
  EXPECT_LT(placement.tracking_covariance(1, 1) / expectation.tracking_covariance(1, 1), 0.01);
}

// Odometry that was right for long and tells a turn late: held as surely as that, a scan may fit well enough.
TEST(Place, TriesWhetherAScanFitsSoMuchBetterElsewhereThatWheelsMustHaveSlipped) {
  const Pose truth{0.4, -0.3, 0.12};
  const Expectation expectation = expecting({0.4, -0.3, 0}, 0.01, 0.002);
  const Placement placement =
      placed(robot_at({}), expectation, local_map_of(furnished_room()), furnished_room(), truth);
  ASSERT_TRUE(placement.matched);
  expect_near(placement.local_from_robot, truth, 0.02, 0.006);
}

// Two doors stand open a little farther than when the map was made. Where they are the scan fits better if it
// is held loosely; but wheels need not have slipped for that, and what the corridor says little of is left to
// them.
TEST(Place, IsHeldByOdometryWhereAScanFitsBetterButWheelsNeedNotHaveSlipped) {
  const auto with_doors_at = [](double x) {
    Walls walls = corridor();
    walls.push_back({{x, 0.9}, {x, 1}});
    walls.push_back({{x + 2, -1}, {x + 2, -0.9}});
    return walls;
  };
  Expectation expectation = expecting({0.3, 0, 0}, 0.07, 0.01);
  expectation.claimed_step = {0.3, 0, 0};
  const Placement placement =
      placed(robot_at({}), expectation, local_map_of(with_doors_at(1.5)), with_doors_at(1.75), {0.3, 0, 0});
  ASSERT_TRUE(placement.matched);
  EXPECT_NEAR(placement.local_from_robot.x, 0.3, 0.05);
}

// Where it fits better than wheels can have slipped to, it is another place that looks alike.
TEST(Place, IsNoFartherFromWhatOdometrySaysThanWheelsSlip) {
  for (const double told_m : {0.0, 0.12}) {
    const Pose truth{0.4, -0.3, 0.03};
    Expectation expectation = expecting({0.52, -0.3, 0}, 0.0015, 0.0006);
    expectation.claimed_step = {told_m, 0, 0};
    const Placement placement =
        placed(robot_at({}), expectation, local_map_of(furnished_room()), furnished_room(), truth);
    ASSERT_TRUE(placement.matched);
    EXPECT_EQ(std::abs(placement.local_from_robot.x - truth.x) < 0.03, told_m > 0)
        << placement.local_from_robot.x;
  }
}

// It may have frozen as the robot set off: then the robot is no farther than it can have driven off since.
TEST(Place, FollowsARobotThatSetsOffWhileOdometryStandsStill) {
  const Pose was{0.4, -0.3, 0.03};
  const auto found_x = [&](double moved_m, double seconds, const Pose& last_step = {}) {
    Robot robot = robot_at(was);
    robot.place->last_step = last_step;
    Expectation expectation = expecting(was, 0.0015, 0.0006);
    expectation.claimed_step = {};
    expectation.seconds = seconds;
    const Pose truth = was * Pose{moved_m, 0, 0};
    const Placement placement =
        placed(robot, expectation, local_map_of(furnished_room()), furnished_room(), truth);
    EXPECT_TRUE(placement.matched);
    return ominus(placement.local_from_robot, was).x;
  };
  EXPECT_NEAR(found_x(0.1, 0.25), 0.1, 0.02);
  EXPECT_LT(found_x(0.3, 0.25), 0.1) << "0.12 m is as far as it can be";
  EXPECT_NEAR(found_x(0.3, 0.25, {0.2, 0, 0}), 0.3, 0.02) << "it drove already";
}

// What it told too little of before it tells at once, and other walls fit there well enough: the robot goes
// on as it did, where the scan fits better. Poses drawn at random, of which one in eighty needs it.
TEST(Place, TriesMotionAsBeforeWhereOdometryTellsTooMuchAtOnce) {
  struct Told {
    Pose was, step, too_much;
    double sigma_m, sigma_rad;
  };
  for (const Told& told :
       {Told{{-1.777, 0.591, 0.009}, {0.223, 0, 0.016}, {0.593, 0, -0.006}, 0.149, 0.038},
        Told{{0.342, -0.956, 1.373}, {0.225, 0, 0.025}, {0.51, 0, 0.084}, 0.129, 0.079},
        Told{{-1.68, -1.264, -0.181}, {0.143, 0, 0.079}, {0.495, 0, -0.052}, 0.085, 0.062},
        Told{{0.534, -2.487, -0.241}, {0.159, 0, 0.017}, {0.505, 0, -0.019}, 0.138, 0.076}}) {
    const Pose truth = told.was * told.step;
    Robot robot = robot_at(told.was);
    robot.place->last_step = told.step;
    Expectation expectation = expecting(truth * told.too_much, told.sigma_m, told.sigma_rad);
    expectation.claimed_step = told.step * told.too_much;
    const Placement placement =
        placed(robot, expectation, local_map_of(furnished_room()), furnished_room(), truth);
    ASSERT_TRUE(placement.matched);
    expect_near(placement.local_from_robot, truth, 0.05, 0.02);
  }
}

// Independent pieces of information about one pose add up. The beams', which errs less with many patches
// than its nominal noise says, is trusted by `match_trust` from scan to scan.
TEST(Place, AddsTheInformationOfTheBeamsToThatOfOdometry) {
  const Expectation expectation = expecting({0.42, -0.3, 0.2});
  EngineOptions options;
  options.localise.match_trust = 3;
  const Placement placement = placed(robot_at({}), expectation, local_map_of(furnished_room()),
                                     furnished_room(), {0.4, -0.3, 0.2}, options);
  ASSERT_TRUE(placement.matched);
  const Eigen::Matrix3d spread_gain =
      placement.tracking_covariance.inverse() - expectation.tracking_covariance.inverse();
  EXPECT_TRUE(spread_gain.isApprox(3 * placement.match.beam_information, 1e-6));
  // What is published has the noise that relations have.
  const double sigma_m = options.match.sigma_m / std::sqrt(3.0);
  const double ratio = sigma_m / relation_sigma_m(placement.match.quality, options.relations);
  const Eigen::Matrix3d gain = placement.covariance.inverse() - expectation.covariance.inverse();
  EXPECT_TRUE(gain.isApprox(ratio * ratio * placement.match.beam_information, 1e-6));
}

TEST(Place, StaysAtItsExpectationWithFewReturns) {
  const Expectation expectation = expecting({0.4, -0.3, 0.2});
  std::vector<ScanPoint> points = to_points(scan_from(furnished_room(), {0.4, -0.3, 0.2}), laser_of(), {});
  points.resize(11);
  const Placement placement =
      localise(robot_at({}), expectation, local_map_of(furnished_room()), points, EngineOptions{});
  EXPECT_EQ(placement.reason, Unmatched::few_returns);
  expect_as_expected(placement, expectation);
}

TEST(Place, StaysAtItsExpectationWhereThereIsNoLocalMap) {
  const Expectation expectation = expecting({0.4, -0.3, 0.2});
  const Placement placement =
      placed(robot_at({}), expectation, {PatchId{0}, {}}, furnished_room(), {0.4, -0.3, 0.2});
  EXPECT_EQ(placement.reason, Unmatched::no_overlap);
  expect_as_expected(placement, expectation);
}

TEST(Place, StaysAtItsExpectationAmongOtherWalls) {
  Walls others;
  add_box(others, -0.7, -0.7, 0.9, 0.8);
  const Expectation expectation = expecting({0, 0, 0}, 0.02, 0.02);
  const Placement placement =
      placed(robot_at({}), expectation, local_map_of(furnished_room()), others, {0, 0, 0});
  EXPECT_TRUE(placement.reason == Unmatched::low_score || placement.reason == Unmatched::few_pairs)
      << word(placement.reason);
  expect_as_expected(placement, expectation);
}

// Wheels that slipped: the scan fits nowhere near where odometry puts the robot.
TEST(Place, SearchesAsFarAsItsCovarianceAllows) {
  const Pose truth{0.4, -0.3, 0.9};
  const Placement placement = placed(robot_at({}), expecting({-0.4, 0.3, 0}, 0.2, 0.2),
                                     local_map_of(furnished_room()), furnished_room(), truth);
  ASSERT_TRUE(placement.matched) << word(placement.reason);
  expect_near(placement.local_from_robot, truth, 0.02, 0.006);
}

// How far it is from where odometry has the robot is weighed by odds, and asks for no better score.
TEST(Place, BelievesAPoorMatchFarFromItsExpectationWhereNothingElseFits) {
  EngineOptions options;
  options.localise.common.doubtful_score = 1.01;  // more than any match has
  const Pose truth{0.4, -0.3, 0.2};
  const auto from = [&](const Pose& expectation) {
    return placed(robot_at({}), expecting(expectation, 0.01, 0.01), local_map_of(furnished_room()),
                  furnished_room(), truth, options);
  };
  EXPECT_TRUE(from(truth * Pose{0.02, 0, 0}).matched);
  EXPECT_TRUE(from(truth * Pose{0.3, 0, 0}).matched);
}

TEST(Place, AsksForABetterScoreAfterOdometryThatCannotBeBelieved) {
  EngineOptions options;
  options.common.sure_score = 1.01;
  options.share_common();
  const Pose truth{0.4, -0.3, 0.2};
  const auto with = [&](bool plausible, bool suspect) {
    Robot robot = robot_at(truth);
    robot.place->suspect = suspect;
    Expectation expectation = expecting(truth);
    expectation.plausible = plausible;
    return placed(robot, expectation, local_map_of(furnished_room()), furnished_room(), truth, options);
  };
  EXPECT_TRUE(with(true, false).matched);
  EXPECT_FALSE(with(false, false).matched);
  EXPECT_FALSE(with(true, true).matched);
}

// Furniture was brought in since: fewer than nineteen of twenty beams fit, as ever.
TEST(Place, AsksForAScoreAsUsualAfterOdometryThatCannotBeBelieved) {
  const Pose truth{0.4, -0.3, 0.2};
  Walls changed = furnished_room();
  add_box(changed, 0.8, -0.9, 1.1, -0.6);
  const auto with = [&](bool plausible, double usual_score, bool sought = false) {
    Robot robot = robot_at(truth);
    robot.place->suspect = sought;
    for (int i = 0; i < 1000; ++i) robot.usual_misfit.learn(usual_score, {});
    Expectation expectation = expecting(truth);
    expectation.plausible = plausible;
    expectation.sought = sought;
    return placed(robot, expectation, local_map_of(furnished_room()), changed, truth);
  };
  const double score = with(true, 1).match.quality.score;
  ASSERT_GT(score, 0.65) << "more than is asked of a robot of which nothing is known";
  ASSERT_LT(score, 0.95);
  EXPECT_TRUE(with(true, 1).matched);
  EXPECT_FALSE(with(false, 1 - (1 - score) / 4).matched);
  EXPECT_TRUE(with(false, 1 - (1 - score) / 2).matched);
  EXPECT_TRUE(with(true, 1 - (1 - score) / 4, true).matched)
      << "where it was sought and found, as it stands there";
  EXPECT_FALSE(with(false, 1 - (1 - score) / 4, true).matched) << "from there odometry has jumped anew";
}

// Odometry that stood still and then jumps: where the laser cannot tell, as in a corridor, it is believed.
TEST(Place, GoesWhereAJumpLedToWhereWallsDoNotObject) {
  Expectation expectation = expecting({0, 0, 0}, 0.5, 0.3);
  expectation.plausible = false;
  expectation.claimed_step = {2, 0, 0};
  // Looked at closely and from all along, so that it is seen as well from anywhere.
  const Scan scan = scan_from(corridor(), {}, 0, 10, 1440);
  LocalMap local_map;
  for (const double x : {-6, -4, -2, 0, 2, 4, 6, 8})
    local_map.patches.push_back({make_patch(PatchId{0}, "R1", scan, laser_of(10), {}), {x, 0, 0}});
  const Placement along =
      localise(robot_at({}), expectation, local_map, to_points(scan, laser_of(10), {}), EngineOptions{});
  ASSERT_TRUE(along.matched) << word(along.reason);
  EXPECT_NEAR(along.local_from_robot.x, 2, 0.1);
  const Placement not_along =
      placed(robot_at({}), expectation, local_map_of(furnished_room()), furnished_room(), {0.1, 0, 0});
  ASSERT_TRUE(not_along.matched) << word(not_along.reason);
  expect_near(not_along.local_from_robot, {0.1, 0, 0}, 0.02, 0.006);
}

// Odometry that is off by more than is searched: the robot may have gone on as before, or stand still.
TEST(Place, TriesMotionAsBeforeAndRest) {
  EngineOptions options;
  options.localise.min_score = 0.7;
  const auto error_m = [&](const Pose& last_step, const Pose& expected, const Pose& truth) {
    Robot robot = robot_at({-1.2, -0.5, 0});
    robot.place->last_step = last_step;
    const Placement placement = placed(robot, expecting(expected, 0.01, 0.01), local_map_of(furnished_room()),
                                       furnished_room(), truth, options);
    const Pose error = ominus(placement.local_from_robot, truth);
    return placement.matched ? std::hypot(error.x, error.y) : 9;
  };
  EXPECT_LT(error_m({2, 0.8, 0.1}, {1.2, -1.5, 0}, {0.82, 0.31, 0.09}), 0.02) << "as before";
  EXPECT_LT(error_m({3, 3, 0.1}, {1.2, -1.5, 0}, {-1.18, -0.48, 0}), 0.02) << "at rest";
  EXPECT_EQ(error_m({3, 3, 0.1}, {1.2, -1.5, 0}, {0.82, 0.31, 0.09}), 9) << "neither";
}

TEST(Placement, IsDoubtfulWhereItFitsBadlyOrNotAtAll) {
  Placement placement;
  EXPECT_TRUE(is_doubtful(placement, {}));
  placement.matched = true;
  placement.match.quality.score = 0.44;
  EXPECT_TRUE(is_doubtful(placement, {}));
  placement.match.quality.score = 0.46;
  EXPECT_FALSE(is_doubtful(placement, {}));
}

}  // namespace
}  // namespace isthmus
