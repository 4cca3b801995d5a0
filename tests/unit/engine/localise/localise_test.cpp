#include "server/engine/localise/localise.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "server/engine/localise/expectation.hpp"
#include "tests/support/poses.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A robot at r on patch 0, with its odometry at time 0.
Robot robot_at(const Pose& patch_from_robot, const Pose& odom_from_robot = {}) {
  Robot robot;
  robot.place = Localisation{};
  robot.place->pose = {PatchId{0}, patch_from_robot};
  robot.place->odom_from_robot = odom_from_robot;
  robot.place->last_patch = PatchId{0};
  return robot;
}

Expectation expected(const Robot& robot, const Pose& odom_from_robot, double seconds = 1) {
  return expect(robot, odom_from_robot, static_cast<std::int64_t>(seconds * 1e6), {});
}

// Eq. 11: the robot's pose on its patch, followed by the change in pose that odometry measured.
TEST(Expect, PutsTheRobotWhereOdometrySays) {
  const Expectation ahead = expected(robot_at({1, 2, quarter_turn}, {5, 5, 0}), {6, 5, 0.1});
  expect_near(ahead.step, {1, 0, 0.1});
  expect_near(ahead.local_from_robot, {1, 3, quarter_turn + 0.1});
  EXPECT_TRUE(ahead.plausible);
  // Where odometry's frame lies says nothing.
  const Expectation turned =
      expected(robot_at({1, 2, quarter_turn}, {5, 5, quarter_turn}), {5, 6, 1.6707963});
  expect_near(turned.local_from_robot, ahead.local_from_robot, 1e-6, 1e-6);
}

TEST(Expect, TakesOutWhatOdometryErrsByAlways) {
  Robot robot = robot_at({});
  for (int i = 0; i < 2000; ++i)
    robot.bias.learn({0.1, 0, 0}, {0.1, 0, 0.003}, 1e-4 * Eigen::Matrix3d::Identity(),
                     Eigen::Matrix2d::Identity(), {}, {});
  const Expectation expectation = expected(robot, {0.5, 0, 0});
  EXPECT_NEAR(expectation.step.yaw, 0.015, 0.001);
  expect_near(expectation.claimed_step, {0.5, 0, 0});
}

// A yaw that is wrong by d puts the end of a step of 2 m aside by 2 d.
TEST(Expect, CarriesTheUncertaintyOfYawToTheEndOfTheStep) {
  Robot robot = robot_at({});
  const Expectation without = expected(robot, {2, 0, 0});
  robot.place->covariance(2, 2) = 0.01;
  robot.place->tracking_covariance(2, 2) = 0.04;
  const Expectation with = expected(robot, {2, 0, 0});
  Eigen::Matrix3d carried;
  carried << 0, 0, 0, 0, 4, 2, 0, 2, 1;
  EXPECT_TRUE((with.covariance - without.covariance).isApprox(0.01 * carried, 1e-9));
  EXPECT_TRUE((with.tracking_covariance - without.tracking_covariance).isApprox(0.04 * carried, 1e-9));
}

TEST(Expect, AddsTheNoiseOfOdometryInTheRobotsOwnDirections) {
  const Robot ahead = robot_at({0, 0, 0});
  const Robot aside = robot_at({0, 0, quarter_turn});
  const Pose step{1, 0.4, 0.2};
  const Eigen::Matrix3d noise = ahead.noise.covariance(step, {});
  EXPECT_TRUE(expected(ahead, step).covariance.isApprox(noise, 1e-9));
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << 0, -1, 1, 0;
  EXPECT_TRUE(expected(aside, step).covariance.isApprox(turn * noise * turn.transpose(), 1e-9));
}

// Odometry froze while the robot turned by 60 degrees, which scans showed: then it tells them all at once.
TEST(Expect, TakesWhatOdometryHadNotToldOutOfAStepThatTellsIt) {
  Robot robot = robot_at({1, 0, 0.2});
  robot.place->untold = {0.1, 0, 1.05};
  robot.place->last_step = {0.02, 0, 0.2};
  const Pose going_on{0.02, 0, 0.19};
  const Expectation expectation = expected(robot, robot.place->untold * going_on, 0.25);
  EXPECT_TRUE(expectation.catches_up);
  EXPECT_TRUE(expectation.plausible) << "as a whole no robot turns like that";
  expect_near(expectation.step, going_on);
  expect_near(expectation.local_from_robot, robot.place->pose.patch_from_object * going_on);
}

// Odometry froze and goes on from where it stopped, or only told late that the robot began to move.
TEST(Expect, TakesAStepAsItIsWhereItIsLikeTheLastOne) {
  Robot robot = robot_at({1, 0, 0.2});
  robot.place->untold = {0.1, 0, 1.05};
  robot.place->last_step = {0.02, 0, 0.2};
  const Expectation expectation = expected(robot, {0.02, 0, 0.19}, 0.25);
  EXPECT_FALSE(expectation.catches_up);
  expect_near(expectation.step, {0.02, 0, 0.19});
  robot.place->untold = {};
  EXPECT_FALSE(expected(robot, {0.02, 0, 0.19}, 0.25).catches_up);
}

// No robot is faster than some metres and half a turn a second.
TEST(Expect, TakesNoStepThatNoRobotMakes) {
  for (const Pose& jump : {Pose{10, 0, 0}, Pose{0, -10, 0}, Pose{0, 0, 3}}) {
    const Expectation expectation = expected(robot_at({1, 2, 0.5}), jump, 0.1);
    EXPECT_FALSE(expectation.plausible);
    expect_near(expectation.step, {});
    expect_near(expectation.claimed_step, jump);
    expect_near(expectation.local_from_robot, {1, 2, 0.5});
    EXPECT_GT(expectation.tracking_covariance(0, 0), 0.1) << "only matching can tell where it is";
    EXPECT_GT(expectation.tracking_covariance(2, 2), 0.05);
  }
  EXPECT_TRUE(expected(robot_at({}), {10, 0, 0}, 10).plausible) << "in ten seconds it does";
  EXPECT_TRUE(expected(robot_at({}), {0, 0, 3}, 10).plausible);
}

TEST(Expect, DoubtsOdometryThatIsBackAtItsOrigin) {
  EXPECT_FALSE(expected(robot_at({}, {0.8, 0, 0}), {0, 0, 0}, 10).plausible) << "switched off and on";
  EXPECT_TRUE(expected(robot_at({}, {0.8, 0, 0}), {0.2, 0, 0}, 10).plausible);
  EXPECT_TRUE(expected(robot_at({}, {0.3, 0, 0}), {0, 0, 0}, 10).plausible) << "it may have driven there";
}

// What a robot at `truth` among `walls` is matched with: one patch, whose frame is `local`.
LocalMap local_map_of(const Walls& walls, const Pose& local_from_patch = {}) {
  return {PatchId{0}, {{patch_from(walls, PatchId{0}, local_from_patch), local_from_patch}}};
}

Expectation expecting(const Pose& local_from_robot, double sigma_m = 0.1, double sigma_rad = 0.05) {
  Expectation expectation;
  expectation.local_from_robot = local_from_robot;
  expectation.tracking_covariance =
      Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
  expectation.covariance = 4 * expectation.tracking_covariance;
  return expectation;
}

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
  options.localise.doubtful_score = 1.01;  // more than any match has
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
  options.localise.min_score_implausible = 1.01;
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
    return placed_anew(robot, expecting(expected, 1e-4, 1e-4), local_map_of(furnished_room()),
                       furnished_room(), truth);
  };
  const std::optional<Placement> agreed = of_room(truth);
  ASSERT_TRUE(agreed);
  EXPECT_LT(agreed->tracking_covariance(0, 0), 1e-8 * 1.001);
  const std::optional<Placement> corrected = of_room({0.4, 0, 0});
  ASSERT_TRUE(corrected);
  EXPECT_GT(corrected->tracking_covariance(0, 0), 1e-8 * 1.001) << "odometry was wrong";
  EXPECT_NEAR(corrected->local_from_robot.x, truth.x, 0.02);
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
  robot.place->lost_scans = 2;
  const std::optional<Placement> placement = placed_anew(robot, near, furnished_room(), truth);
  ASSERT_TRUE(placement);
  expect_near(placement->local_from_robot, truth, 0.02, 0.006);
}

// A square room is itself after a quarter turn.
TEST(LocaliseAnew, SaysNothingWhereTwoPosesFitAboutAsWell) {
  Walls square;
  add_box(square, -3, -3, 3, 3);
  Robot robot = robot_at({});
  robot.place->lost_scans = 10;
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
