#include "server/engine/localise/extend.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>
#include <utility>

#include "server/engine/localise/follow.hpp"
#include "tests/support/patch_scenes.hpp"
#include "tests/support/poses.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr double half_turn_rad = std::numbers::pi;

// A robot in a room whose first scan, from the world's origin, has begun an island.
struct InARoom {
  explicit InARoom(Walls seen = furnished_room()) : walls(std::move(seen)) {
    robot.declaration.robot = "R1";
    robot.declaration.laser = laser_of();
    begin({}, 1'000'000);
  }
  void begin(const Pose& world_from_robot, std::int64_t utime, const Pose& odom_from_robot = {3, 4, 0.5}) {
    begin_island(map, robot, seen_from(world_from_robot, utime), odom_from_robot, options);
  }
  Observation seen_from(const Pose& world_from_robot, std::int64_t utime = 2'000'000) const {
    return observe(scan_from(walls, world_from_robot, utime), laser_of(), options.patch);
  }
  // The scan from there matched with the local map, expected where it was taken; the world is the first
  // patch's frame.
  Placement matched(const Pose& world_from_robot) {
    const Observation seen = seen_from(world_from_robot);
    const Pose local_from_robot = ominus(world_from_robot, map.manifold().pose(robot.place->pose.patch));
    choose_local_map(map, robot, local_from_robot, seen.points, options);
    Expectation expectation;
    expectation.local_from_robot = local_from_robot;
    expectation.tracking_covariance = expectation.covariance =
        Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal();
    return localise(robot, expectation, robot.local_map, seen.points, options);
  }
  bool extended_by(const Pose& world_from_robot, const Placement& placement) {
    robot.place->pose.patch_from_object = placement.local_from_robot;  // it has been followed to there
    return extend(map, robot, seen_from(world_from_robot), placement, options);
  }
  bool is_worth_it(const Pose& world_from_robot) {
    const Placement placement = matched(world_from_robot);
    EXPECT_TRUE(placement.matched) << word(placement.reason);
    return is_worth_it(world_from_robot, placement);
  }
  bool is_worth_it(const Pose& world_from_robot, const Placement& placement) {
    return worth_a_patch(map, robot.surroundings, placement, seen_from(world_from_robot).star, options);
  }

  Walls walls;
  EngineOptions options;
  Map map;
  Robot robot;
};

std::vector<const Relation*> relations_between(const Map& map, int a, int b) {
  std::vector<const Relation*> found;
  for (const RelationId id : map.graph().between(PatchId{a}, PatchId{b}))
    found.push_back(map.graph().find(id));
  return found;
}

TEST(BeginIsland, PutsTheRobotAtTheOriginOfItsFirstPatch) {
  InARoom in;
  ASSERT_EQ(in.map.manifold().size(), 1U);
  expect_near(in.map.manifold().pose(PatchId{0}), {});
  EXPECT_EQ(in.map.manifold().patch(PatchId{0}).robot, "R1");
  EXPECT_EQ(in.map.manifold().patch(PatchId{0}).utime, 1'000'000);
  const Localisation& place = *in.robot.place;
  EXPECT_EQ(place.pose.patch, PatchId{0});
  expect_near(place.pose.patch_from_object, {});
  expect_near(place.odom_from_robot, {3, 4, 0.5});
  EXPECT_EQ(place.utime, 1'000'000);
  EXPECT_EQ(place.last_patch, PatchId{0});
}

TEST(BeginIsland, SharesNothingWithTheIslandBefore) {
  InARoom in;
  in.robot.place->suspect = true;
  in.robot.place->lost_scans = 8;
  in.begin({1, 0, 0}, 2'000'000);
  EXPECT_NE(in.map.graph().island(PatchId{1}), in.map.graph().island(PatchId{0}));
  EXPECT_EQ(in.robot.place->pose.patch, PatchId{1});
  EXPECT_FALSE(in.robot.place->suspect);
  EXPECT_EQ(in.robot.place->lost_scans, 0);
  EXPECT_EQ(in.robot.patches, 2U);
}

// Eq. 15: the patch is where the scan was placed, and the robot at its origin.
TEST(Extend, PutsTheRobotAtTheOriginOfTheNewPatch) {
  InARoom in;
  const Pose truth{0.8, 0.3, 0.2};
  in.robot.place->append(truth, in.robot.noise.covariance(truth, {}));
  in.extended_by(truth, in.matched(truth));
  ASSERT_EQ(in.map.manifold().size(), 2U);
  expect_near(in.map.manifold().pose(PatchId{1}), truth, 0.02);
  EXPECT_EQ(in.map.manifold().patch(PatchId{1}).utime, 2'000'000);
  const Localisation& place = *in.robot.place;
  EXPECT_EQ(place.pose.patch, PatchId{1});
  expect_near(place.pose.patch_from_object, {});
  EXPECT_LT(place.covariance.trace(), 1e-6) << "the patch is where the robot is";
  EXPECT_LT(place.tracking_covariance.trace(), 1e-6);
  EXPECT_EQ(place.last_patch, PatchId{1});
  expect_near(place.since_last_patch.start_from_end, {});
  EXPECT_EQ(place.told_since_last_patch.rad, 0);
  EXPECT_EQ(place.told_since_last_patch.variance_rad2, 0);
  EXPECT_EQ(in.robot.patches, 2U);
}

// "The patch and its relations are appended to the map": the match's, and odometry's.
TEST(Extend, AppendsTheRelationsOfTheMatchAndOfOdometry) {
  InARoom in;
  const Pose truth{0.8, 0.3, 0.2};
  const Pose said{0.82, 0.31, 0.2};
  in.robot.place->append(said, in.robot.noise.covariance(said, {}));
  EXPECT_FALSE(in.extended_by(truth, in.matched(truth))) << "no loop";
  const std::vector<const Relation*> relations = relations_between(in.map, 0, 1);
  ASSERT_EQ(relations.size(), 2U);
  EXPECT_EQ(relations[0]->kind, RelationKind::odometry);
  EXPECT_EQ(relations[0]->a, PatchId{0});
  expect_near(std::get<RelativePose>(relations[0]->measurement).a_from_b, said);
  EXPECT_EQ(relations[1]->kind, RelationKind::point_to_line);
  EXPECT_EQ(relations[1]->origin.kind, OriginKind::match);
  expect_near(minimiser(relations[1]->measurement, truth), truth, 0.02);
}

// Odometry told a turn of 2 rad that the robot never made, as one that tells a turn on the spot late does: it
// has counted its way all the same.
TEST(Extend, KeepsTheWayOfOdometryThatTurnsAreCountedWrongIn) {
  InARoom in(corridor());
  const Eigen::Matrix3d noise = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
  for (int i = 0; i < 10; ++i) {
    in.robot.place->append({0.1, 0, 0.2}, noise);
    in.robot.place->since_last_patch.face(0, 1e-6);
  }
  const Pose truth{1, 0, 0};
  in.extended_by(truth, in.matched(truth));
  const std::vector<const Relation*> relations = relations_between(in.map, 0, 1);
  ASSERT_EQ(relations[0]->kind, RelationKind::odometry);
  const auto& told = std::get<RelativePose>(relations[0]->measurement);
  expect_near(told.a_from_b, {1, 0, 2});
  const Eigen::Matrix3d covariance = told.information.inverse();
  EXPECT_LT(covariance(0, 0), 5 * 10 * noise(0, 0)) << "the way is as sure as ever";
  EXPECT_GT(covariance(2, 2), 0.5) << "the turn is not";
  EXPECT_NEAR(covariance(0, 2), 0, 1e-6);
}

void learn_little_of_bias(Robot& robot) {
  const Pose step{0.5, 0, 0.1};
  for (int i = 0; i < 10; ++i)
    robot.bias.learn(step, 0, step, Eigen::Matrix3d::Identity(), Eigen::Matrix2d::Identity(), {}, {});
  ASSERT_GT(robot.bias.path_yaw_variance(step, {}), 1e-3);
}

TEST(Extend, RelatesAnUnmatchedScanByOdometryAlone) {
  InARoom in;
  learn_little_of_bias(in.robot);
  const Pose said{0.8, 0.3, 0.2};
  in.robot.place->append(said, in.robot.noise.covariance(said, {}));
  Placement placement = in.matched(said);
  placement.matched = false;
  in.extended_by(said, placement);
  const std::vector<const Relation*> relations = relations_between(in.map, 0, 1);
  ASSERT_EQ(relations.size(), 1U);
  EXPECT_EQ(relations[0]->kind, RelationKind::odometry);
  Eigen::Matrix3d covariance =
      in.robot.noise.path_covariance(said, in.robot.noise.covariance(said, {}), said, false, {});
  covariance(2, 2) += in.robot.bias.path_yaw_variance(said, {});
  EXPECT_TRUE(
      std::get<RelativePose>(relations[0]->measurement).information.isApprox(covariance.inverse(), 1e-6))
      << "as far as paths of odometry err, each by itself and together";
}

// A robot in a corridor that has come back on its first patch, after a second one a metre ahead; its odometry
// since then is a metre wrong.
struct BackInACorridor : InARoom {
  explicit BackInACorridor(Walls seen = corridor()) : InARoom(std::move(seen)) {
    const Pose ahead{1, 0, 0};
    robot.place->append(ahead, robot.noise.covariance(ahead, {}));
    extended_by(ahead, matched(ahead));
    robot.place->pose = {PatchId{0}, {}};
    robot.place->append({-0.6, 0, 0}, Eigen::Vector3d(1, 1, 0.1).asDiagonal());
  }
  const Relation* ground_of_patch_2() const {
    for (const Relation* relation : relations_between(map, 0, 2))
      if (relation->kind == RelationKind::relative_pose) return relation;
    return nullptr;
  }
  const Pose back{-0.6, 0, 0};
};

// Along a bare corridor neither the scan nor odometry since the last patch says where it is: the way that was
// tracked does.
TEST(Extend, KeepsAScanWhereItWasTrackedToInTheDirectionThatItDoesNotTell) {
  BackInACorridor in;
  in.extended_by(in.back, in.matched(in.back));
  expect_near(in.map.manifold().pose(PatchId{2}), in.back, 0.03);
  const Relation* ground = in.ground_of_patch_2();
  ASSERT_TRUE(ground);
  EXPECT_EQ(ground->origin.kind, OriginKind::match) << "a part of the scan's placing";
  const Eigen::Matrix3d& information = std::get<RelativePose>(ground->measurement).information;
  EXPECT_NEAR(information(0, 0), 1 / 0.01 - 1 / 1.0, 5) << "beyond what odometry says";
  EXPECT_NEAR(information(1, 1), 0, 1e-3) << "which walls tell";
  EXPECT_EQ(information(2, 2), 0);
}

TEST(Extend, KeepsAScanByNothingElseWhereItTellsOrOdometryDoes) {
  BackInACorridor in_a_room(furnished_room());
  in_a_room.extended_by(in_a_room.back, in_a_room.matched(in_a_room.back));
  EXPECT_FALSE(in_a_room.ground_of_patch_2()) << "the scan tells";
  BackInACorridor in;
  in.robot.place->since_last_patch = {};
  in.robot.place->told_since_last_patch = {};
  in.robot.place->append({-1.6, 0, 0}, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal());
  in.extended_by(in.back, in.matched(in.back));
  EXPECT_FALSE(in.ground_of_patch_2()) << "odometry tells more";
}

// Eq. 16 around the new patch: two relations that disagree meet between.
TEST(Extend, RefitsTheMapAroundTheNewPatch) {
  InARoom in;
  const Pose truth{0.8, 0.3, 0.2};
  in.robot.place->append({0.8, 0.3, 0.2}, 1e-8 * Eigen::Matrix3d::Identity());
  Placement placement = in.matched(truth);
  placement.local_from_robot = truth * Pose{0.3, 0, 0};
  in.extended_by(truth, placement);
  expect_near(in.map.manifold().pose(PatchId{1}), truth, 0.03);
}

TEST(OdometryRelation, TellsTheWayFromTheNewestOwnPatch) {
  InARoom in;
  learn_little_of_bias(in.robot);
  in.robot.place->append({1, 0, 0}, Eigen::Matrix3d::Identity() * 0.01);
  const Relation relation = odometry_relation(in.robot, PatchId{5}, {});
  EXPECT_EQ(relation.a, PatchId{0});
  EXPECT_EQ(relation.b, PatchId{5});
  EXPECT_EQ(relation.kind, RelationKind::odometry);
  EXPECT_EQ(relation.origin.kind, OriginKind::odometry);
  const auto& told = std::get<RelativePose>(relation.measurement);
  expect_near(told.a_from_b, {1, 0, 0});
  const Eigen::Matrix3d alone =
      in.robot.noise.path_covariance({1, 0, 0}, Eigen::Matrix3d::Identity() * 0.01, {1, 0, 0}, false, {});
  EXPECT_NEAR(told.information.inverse()(2, 2), alone(2, 2) + in.robot.bias.path_yaw_variance({1, 0, 0}, {}),
              1e-9)
      << "it turns as the ways before and after it do";
}

TEST(WorthAPatch, IsAScanFarFromEveryPatch) {
  InARoom in;
  EXPECT_FALSE(in.is_worth_it({0.05, 0, 0}));
  EXPECT_FALSE(in.is_worth_it({0.9, 0, 0}));
  EXPECT_TRUE(in.is_worth_it({1.1, 0, 0}));
}

// Turned by half a radian, about a sixth of what half a turn sees is new.
TEST(WorthAPatch, IsAScanThatShowsMuchThatNobodyHasSeen) {
  InARoom in;
  EXPECT_FALSE(in.is_worth_it({0, 0, 0.5}));
  in.options.uncovered_share = 0.08;
  EXPECT_TRUE(in.is_worth_it({0, 0, 0.5}));
}

TEST(WorthAPatch, IsAScanTurnedAwayFromThoseTakenThere) {
  InARoom in;
  EXPECT_FALSE(in.is_worth_it({0, 0, 0.1}));
  EXPECT_TRUE(in.is_worth_it({0, 0, 1.2}));
  // Once it is a patch, that side has been seen.
  in.extended_by({0, 0, 1.2}, in.matched({0, 0, 1.2}));
  EXPECT_FALSE(in.is_worth_it({0, 0, 1.2}));
  EXPECT_FALSE(in.is_worth_it({0, 0, 0.9}));
}

TEST(WorthAPatch, IsAScanThatFitsBadlyUnlessOneWasMadeThere) {
  InARoom in;
  Placement here = in.matched({0.1, 0, 0});
  here.match.quality.score = 0.3;
  EXPECT_FALSE(in.is_worth_it({0.1, 0, 0}, here));
  Placement farther = in.matched({0.6, 0, 0});
  EXPECT_FALSE(in.is_worth_it({0.6, 0, 0}, farther));
  farther.match.quality.score = 0.3;
  EXPECT_TRUE(in.is_worth_it({0.6, 0, 0}, farther));
}

// Far patches, and those only loosely known, cover nothing.
TEST(WorthAPatch, DoesNotCountWhatIsLooselyDetermined) {
  InARoom in;
  const Pose truth{1.5, 0, 0};
  const PatchId loose = in.map.manifold().next_id();
  in.map.add(patch_from(in.walls, loose, truth), truth);
  in.map.relate(testing::odometry_relation(PatchId{0}, loose, truth, {1, 1, 100}));
  EXPECT_TRUE(in.is_worth_it(truth));
  in.map.relate(testing::odometry_relation(PatchId{0}, loose, truth));
  EXPECT_FALSE(in.is_worth_it(truth));
}

Star disc(float range_m) { return {full_turn(360, range_m), {}, 80, 0}; }

double uncovered_by(const Star& star, const std::vector<std::pair<PatchPtr, Pose>>& patches,
                    const Pose& local_from_robot = {}) {
  std::vector<LocalPatch> near;
  for (const auto& [patch, local_from_patch] : patches) near.push_back({patch, local_from_patch});
  return uncovered_share(star, near, local_from_robot, {});
}

PatchPtr disc_patch(float range_m) { return make_patch(PatchId{0}, "R1", full_turn(360, range_m), {}, {}); }

TEST(UncoveredShare, IsAllWhereNobodyLooked) {
  EXPECT_EQ(uncovered_by(disc(4), {}), 1);
  EXPECT_EQ(uncovered_by(disc(4), {{disc_patch(4), {20, 0, 0}}}), 1);
}

TEST(UncoveredShare, IsNothingWhereTheSameWasSeen) {
  EXPECT_EQ(uncovered_by(disc(4), {{disc_patch(4), {}}}), 0);
  EXPECT_EQ(uncovered_by(disc(4), {{disc_patch(4), {5, 5, 1}}}, {5, 5, -2}), 0) << "wherever that is";
}

TEST(UncoveredShare, IsOfTheArea) {
  const PatchPtr half = make_patch(PatchId{0}, "R1", half_turn(181, 4), {}, {});
  EXPECT_NEAR(uncovered_by(disc(4), {{half, {}}}), 0.5, 0.03);
  EXPECT_NEAR(uncovered_by(disc(4), {{half, {}}, {half, {0, 0, half_turn_rad}}}), 0, 0.03);
  // A disc whose area is a third or two of it covers one or two of three samples.
  EXPECT_NEAR(uncovered_by(disc(4), {{disc_patch(4 * std::sqrt(1.0F / 3)), {}}}), 2.0 / 3, 1e-9);
  EXPECT_NEAR(uncovered_by(disc(4), {{disc_patch(4 * std::sqrt(2.0F / 3)), {}}}), 1.0 / 3, 1e-9);
}

}  // namespace
}  // namespace isthmus
