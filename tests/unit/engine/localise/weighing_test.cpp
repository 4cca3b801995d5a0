#include "server/engine/localise/weighing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// What a robot at the origin saw, what it sees now, and what its wheels say of the way between.
struct Step {
  LocalMap before;
  std::vector<ScanPoint> now;
  Expectation expectation;

  Match matched(const EngineOptions& options = {}) const {
    return match_scan(before, now, {{}, Eigen::Matrix3d::Identity()}, options.match);
  }
  std::optional<Match> held(const EngineOptions& options = {}) const {
    return held_by_odometry(before, now, expectation, matched(options), options.match, options);
  }
};

Step step_of(const Walls& walls_before, const Walls& walls_now, const Pose& truth, const Pose& expected,
             double sigma_m = 0.02) {
  Step step;
  step.before = {PatchId{0}, {{patch_from(walls_before, PatchId{0}, {}), {}}}};
  step.now = to_points(scan_from(walls_now, truth), laser_of(), {});
  step.expectation.local_from_robot = expected;
  step.expectation.tracking_covariance =
      Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, 1e-4).asDiagonal();
  step.expectation.covariance = step.expectation.tracking_covariance;
  return step;
}

// A corridor with somebody in it, half a metre wide.
Walls corridor_with_somebody_at(double x) {
  Walls walls = corridor();
  add_box(walls, x, -0.25, x + 0.3, 0.25);
  return walls;
}

// A corridor that ends: a wall across, wider than anybody.
Walls corridor_to(double x) {
  Walls walls = corridor();
  walls.push_back({{x, -1}, {x, 1}});
  return walls;
}

//  |=====================|
//     robot ->  somebody ->       who keeps the distance: the scan is the same as before.
//  |=====================|
TEST(HeldByOdometry, WhereSomebodyWalksAheadThroughACorridor) {
  const Step step =
      step_of(corridor_with_somebody_at(1.5), corridor_with_somebody_at(1.7), {0.2, 0, 0}, {0.2, 0, 0});
  ASSERT_NEAR(step.matched().local_from_robot.x, 0, 0.03) << "held back by them";
  const std::optional<Match> held = step.held();
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->local_from_robot.x, 0.2, 0.01);
  EXPECT_NEAR(held->local_from_robot.y, 0, 0.01);
}

TEST(HeldByOdometry, SaysNothingOfTheDirectionInWhichItIsHeld) {
  const Step step =
      step_of(corridor_with_somebody_at(1.5), corridor_with_somebody_at(1.7), {0.2, 0, 0}, {0.2, 0, 0});
  const std::optional<Match> held = step.held();
  ASSERT_TRUE(held);
  EXPECT_LT(held->beam_information(0, 0), 1e-3 * held->beam_information(1, 1));
  EXPECT_LT((held->direction_trust * Eigen::Vector2d::UnitX()).norm(), 0.1);
  EXPECT_GT((held->direction_trust * Eigen::Vector2d::UnitY()).norm(), 0.9);
}

// Two who walk side by side hold as many beams as a wall.
TEST(HeldByOdometry, IsNotTrustedInTheDirectionInWhichItIsHeld) {
  const auto with_two_at = [](double x) {
    Walls walls = corridor();
    add_box(walls, x, -0.7, x + 0.3, -0.1);
    add_box(walls, x + 0.45, 0.1, x + 0.75, 0.7);
    return walls;
  };
  EngineOptions options;
  options.localise.match_variance_m2 = 1e-6;  // so that a step as small is a surprise
  const Step step = step_of(with_two_at(1.1), with_two_at(1.15), {0.05, 0, 0}, {0.05, 0, 0}, 0.004);
  MatchOptions as_it_is = options.match;
  as_it_is.max_iterations = 0;
  const Match there = match_scan(step.before, step.now, {{0.05, 0, 0}, Eigen::Matrix3d::Zero()}, as_it_is);
  ASSERT_GT((there.direction_trust * Eigen::Vector2d::UnitX()).norm(), 0.4);
  const std::optional<Match> held = step.held(options);
  ASSERT_TRUE(held);
  EXPECT_LT((held->direction_trust * Eigen::Vector2d::UnitX()).norm(), 0.01);
}

// Also where odometry is known so badly that its step is no surprise.
TEST(HeldByOdometry, WhereOnlyWhatMayMoveSpeaksForTheMatch) {
  const Step step =
      step_of(corridor_with_somebody_at(1.5), corridor_with_somebody_at(1.7), {0.2, 0, 0}, {0.2, 0, 0}, 0.05);
  ASSERT_LT(surprise(step.matched().local_from_robot, step.expectation, {}),
            CommonOptions{}.surprise.bound(3));
  EXPECT_TRUE(step.held());
}

// Two dozen beams on a piece of wall fit many a place: for a turn that no wheels slip by they say too little.
TEST(HeldByOdometry, WhereAFewBeamsSpeakForWhatNoWheelsSlipBy) {
  Step slips = step_of(furnished_room(), furnished_room(), {}, {0.2, 0.2, 0});
  slips.now.resize(24);
  Step turned_about = slips;
  turned_about.expectation.local_from_robot.yaw = 2.8;
  EXPECT_TRUE(turned_about.held());
  EXPECT_FALSE(slips.held());
}

// Somebody who walks an arm's length ahead takes most of the beams.
TEST(HeldByOdometry, WhereSomebodyRightAheadTakesMostOfTheBeams) {
  const Step step =
      step_of(corridor_with_somebody_at(0.2), corridor_with_somebody_at(0.4), {0.2, 0, 0}, {0.2, 0, 0});
  const auto theirs = std::ranges::count_if(step.now, [](const ScanPoint& p) {
    return p.position.x() > 0 && p.position.x() < 0.7 && std::abs(p.position.y()) < 0.3;
  });
  ASSERT_GT(2 * theirs, std::ssize(step.now));
  const std::optional<Match> held = step.held();
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->local_from_robot.x, 0.2, 0.01);
  EXPECT_GT(held->quality.score, 0.9) << "what stands fits";
}

// A gap narrower than a person beside a wall that runs on behind: the beams' angle tells the two apart.
TEST(HeldByOdometry, WhereSomebodyWalksAlongCloseToTheWall) {
  const auto with_somebody_at = [](double x) {
    Walls walls = corridor();
    add_box(walls, x, 0.15, x + 0.3, 0.8);
    return walls;
  };
  const Step step = step_of(with_somebody_at(1.0), with_somebody_at(1.2), {0.2, 0, 0}, {0.2, 0, 0});
  EXPECT_TRUE(step.held());
}

// One thing that small may move along; that five do, at one pace, would be a wonder.
TEST(HeldByOdometry, NotWhereMoreThingsWouldHaveToMoveAlongThanLikely) {
  Walls walls = corridor();
  for (const double bearing : {-0.98, -0.49, 0.0, 0.49, 0.98}) {
    const Eigen::Vector2d at = 0.75 * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
    add_box(walls, at.x() - 0.1, at.y() - 0.1, at.x() + 0.1, at.y() + 0.1);
  }
  EXPECT_FALSE(step_of(walls, walls, {}, {0.2, 0, 0}).held());
}

// Wheels that turn at a wall: no wall moves along.
TEST(HeldByOdometry, NotWhereWhatStandsSaysThatWheelsSlip) {
  EXPECT_FALSE(step_of(corridor_to(2), corridor_to(2), {}, {0.2, 0, 0}).held());
  EXPECT_FALSE(step_of(corridor_to(2), corridor_to(2), {}, {0.2, 0, 0}, 0.004).held())
      << "however sure odometry is of itself: wheels do slip";
  EXPECT_FALSE(step_of(furnished_room(), furnished_room(), {}, {0.2, 0.1, 0}).held());
}

TEST(HeldByOdometry, NotWhereAMatchIsNoSurprise) {
  EXPECT_FALSE(step_of(furnished_room(), furnished_room(), {0.2, 0, 0}, {0.21, 0, 0}).held());
}

// Where nothing in view is large, all of it is weighed.
TEST(HeldByOdometry, NotByWhatMayMoveWhereThatIsAllThereIs) {
  Walls pillars;
  for (const auto& [x, y] :
       {std::pair{2.0, 0.3}, {2.5, -1.5}, {1.2, 1.8}, {3.0, 2.5}, {0.4, -2.2}, {1.5, -3.0}})
    add_box(pillars, x, y, x + 0.5, y + 0.5);
  EXPECT_FALSE(step_of(pillars, pillars, {}, {0.25, 0.1, 0}).held());
}

// Right before a shelf, which is nearly all there is to see: nothing stands against which it would move.
TEST(HeldByOdometry, NotWhereOneThingFillsTheView) {
  Walls shelf;
  shelf.push_back({{0.3, -0.4}, {0.35, 0}});
  shelf.push_back({{0.35, 0}, {0.3, 0.5}});
  shelf.push_back({{2, -3.3}, {2, -3.2}});
  EXPECT_FALSE(step_of(shelf, shelf, {}, {0, 0.1, 0.2}).held());
}

// A corridor with a pillar on either side each half metre.
//  |_'_'_'_'_'_'_'
//    robot ->
//  |_._._._._._._.
Walls corridor_of_pillars(double to_x) {
  Walls walls;
  for (const double side : {-1.0, 1.0}) walls.push_back({{-3, side}, {to_x, side}});
  for (double x = -2.85; x < to_x; x += 0.5) {
    add_box(walls, x, 0.8, x + 0.2, 1);
    add_box(walls, x, -1, x + 0.2, -0.8);
  }
  return walls;
}

// Found where the pillars fit half a metre off.
Match matched_off(const Step& step, const Pose& start) {
  MatchOptions near = EngineOptions{}.match;
  near.start_kernel_m = near.kernel_m;
  return match_scan(step.before, step.now, {start, 400 * Eigen::Matrix3d::Identity()}, near);
}

// A corridor with doors, and perhaps a cupboard on each side.
Walls corridor_with_doors(bool has_cupboards) {
  Walls walls;
  for (const double side : {-1.0, 1.0}) {
    const double back = 1.15 * side;
    walls.push_back({{-3, side}, {5, side}});
    walls.push_back({{5, side}, {5, back}});
    walls.push_back({{5, back}, {6, back}});
    walls.push_back({{6, back}, {6, side}});
    walls.push_back({{6, side}, {9, side}});
    if (has_cupboards) add_box(walls, 1.6, std::min(side, 0.7 * side), 2.8, std::max(side, 0.7 * side));
  }
  return walls;
}

// The cupboards are gone that stood beside where the robot is: the beams that go farther there than the map
// has it would not a metre before.
TEST(HeldByOdometry, WhereFurnitureIsGoneThatTheMapHas) {
  const Step step = step_of(corridor_with_doors(true), corridor_with_doors(false), {1.5, 0, 0}, {1.5, 0, 0});
  const Match off = matched_off(step, {0.3, 0, 0});
  ASSERT_NEAR(off.local_from_robot.x, 0.3, 0.3);
  const auto held = held_by_odometry(step.before, step.now, step.expectation, off, EngineOptions{}.match, {});
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->local_from_robot.x, 1.5, 0.02);
}

// Wheels that turn before a wall where corridors cross: nobody moves as much of a wall.
TEST(HeldByOdometry, NotWhereMoreOfAWallWouldHaveToHaveMovedThanFurnitureIsWide) {
  Walls crossing{{{-3, -1}, {1.8, -1}}, {{-3, 1}, {1.8, 1}}};
  crossing.push_back({{3, -3}, {3, 3}});
  EXPECT_FALSE(step_of(crossing, crossing, {}, {0.25, 0, 0}).held());
}

// Odometry whose yaw froze while the robot turned has counted its way all the same.
TEST(HeldByOdometry, WhereOnlyTurnsAreCountedWrong) {
  const Pose truth{0.2, 0, 0.4};
  const Step step = step_of(corridor_of_pillars(8), corridor_of_pillars(8), truth, {0.2, 0, 0});
  const Match off = matched_off(step, {-0.3, 0, 0.4});
  ASSERT_NEAR(off.local_from_robot.x, -0.3, 0.05);
  const auto held = held_by_odometry(step.before, step.now, step.expectation, off, EngineOptions{}.match, {});
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->local_from_robot.x, truth.x, 0.02);
  EXPECT_NEAR(held->local_from_robot.yaw, truth.yaw, 0.01);
}

// But where the way that was counted does not fit at the heading that scans show, it is not believed.
TEST(HeldByOdometry, NotWhereTurnsAndWayAreCountedWrong) {
  EXPECT_FALSE(step_of(furnished_room(), furnished_room(), {-0.2, 0.1, 0.3}, {0.2, 0, 0}).held());
}

// A corridor of which the robot has seen a metre ahead. Half a metre back more of what it sees lies on walls
// that it knows.
TEST(HeldByOdometry, WhereTheMatchOnlyHasMoreOfTheScanOnKnownGround) {
  const auto corridor_to_x = [](double x) { return Walls{{{-3, -1}, {x, -1}}, {{-3, 1}, {x, 1}}}; };
  const Step step = step_of(corridor_to_x(1), corridor_to_x(8), {0.2, 0, 0}, {0.2, 0, 0});
  const Match back = matched_off(step, {-0.3, 0, 0});
  ASSERT_NEAR(back.local_from_robot.x, -0.3, 0.05);
  const auto held =
      held_by_odometry(step.before, step.now, step.expectation, back, EngineOptions{}.match, {});
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->local_from_robot.x, 0.2, 0.02);
}

// Few returns, as in a hall beyond the laser's range: all of them are on ground that nobody has seen, but for
// a shelf that is elsewhere in the map too.
TEST(HeldByOdometry, ByNoMatchAtAllWhereAllOfTheScanIsOnUnknownGround) {
  Walls shelf_at_start;
  add_box(shelf_at_start, 1, -0.5, 1.4, 0.5);
  Walls shelf_farther_on;
  add_box(shelf_farther_on, 7, -0.5, 7.4, 0.5);
  const Step step = step_of(shelf_at_start, shelf_farther_on, {6, 0, 0}, {6, 0, 0});
  const Match at_start = matched_off(step, {});
  ASSERT_TRUE(at_start.ok);
  const auto held =
      held_by_odometry(step.before, step.now, step.expectation, at_start, EngineOptions{}.match, {});
  ASSERT_TRUE(held);
  EXPECT_FALSE(held->ok) << "where odometry has the robot there is nothing to match with";
  EXPECT_EQ(held->local_from_robot, step.expectation.local_from_robot);
}

// However few points a scan has, each says one log-odds at most.
TEST(HeldByOdometry, IsWeighedTheLessTheFewerPointsThereAre) {
  const Step step = step_of(corridor_to(2), corridor_to(2), {}, {0.2, 0, 0});
  Step sparse = step;
  sparse.now.clear();
  for (std::size_t i = 0; i < step.now.size(); i += step.now.size() / 12) sparse.now.push_back(step.now[i]);
  MatchOptions few = EngineOptions{}.match;
  few.min_pairs = 5;
  const Match match = match_scan(sparse.before, sparse.now, {{}, Eigen::Matrix3d::Identity()}, few);
  ASSERT_TRUE(match.ok);
  EXPECT_FALSE(step.held());
  EXPECT_TRUE(held_by_odometry(sparse.before, sparse.now, sparse.expectation, match, few, {}));
}

TEST(Surprise, IsAsManySigmasAsOdometryAndMatchingErrBy) {
  const Step step = step_of(corridor(), corridor(), {}, {0.2, 0, 0}, 0.03);
  LocaliseOptions options;
  options.match_variance_m2 = 0.0016;
  EXPECT_NEAR(surprise({0.3, 0, 0}, step.expectation, options), 0.01 / (0.0009 + 0.0016), 1e-9);
}

}  // namespace
}  // namespace isthmus
