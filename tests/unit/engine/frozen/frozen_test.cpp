#include "server/engine/frozen/frozen.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/engine/frozen/given_pose.hpp"
#include "server/engine/frozen/sighted_pose.hpp"
#include "server/engine/sightings/evidence.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

Map mapped_hall() {
  Map map;
  std::vector<Pose> poses;
  for (int i = 0; i < 16; ++i) poses.push_back({1.0 * i, 0, 0});
  add_way(map, niched_hall(), poses);
  return map;
}

// A robot on a map of a hall that does not change.
struct OnTheMap {
  explicit OnTheMap(const Pose& world_from_robot) {
    robot.declaration.robot = "R9";
    robot.declaration.laser = laser_of();
    robot.session = 0;
    robot.place = Localisation{};
    robot.place->pose = {PatchId{0}, world_from_robot};
    robot.place->odom_from_robot = world_from_robot;
    robot.place->covariance = robot.place->tracking_covariance = 0.01 * Eigen::Matrix3d::Identity();
    robot.place->last_patch = PatchId{0};
  }
  std::optional<ScanOutcome> scan(const Pose& truth, const Pose& odometry,
                                  const Walls& walls = niched_hall()) {
    utime += 100'000;
    return frozen.take_scan(map, robot, observe(scan_from(walls, truth, utime), laser_of(), {}), odometry,
                            options);
  }
  std::optional<ScanOutcome> scan(const Pose& truth) { return scan(truth, truth); }
  // Time for searches.
  void wait() {
    while (frozen.has_work()) frozen.advance(map, options, now += 100'000);
  }

  EngineOptions options;
  const Map map = mapped_hall();
  Frozen frozen{map, options};
  Robot robot;
  std::int64_t utime = 0;
  std::int64_t now = 0;
};

TEST(Frozen, FollowsARobotOverTheMapWithoutExtendingIt) {
  OnTheMap on({0, 0, 0});
  for (double x = 0.1; x < 6; x += 0.1) {
    const auto outcome = on.scan({x, 0.3, 0});
    ASSERT_TRUE(outcome) << x;
    EXPECT_TRUE(outcome->pose.matched) << x;
    EXPECT_NEAR(outcome->pose.map_from_robot.x, x, 0.05);
  }
  EXPECT_GE(on.robot.place->pose.patch, PatchId{4}) << "eq. 14 alone, without eq. 15";
  EXPECT_EQ(on.robot.patches, 0U);
}

TEST(Frozen, TellsNoPoseOfARobotThatItDoesNotKnow) {
  OnTheMap on({});
  on.robot.place.reset();
  EXPECT_FALSE(on.scan({5, 0, 0}, {}));
  EXPECT_EQ(on.robot.unplaced.size(), 1U) << "to be placed once the robot is found";
}

// It is found on the way, and from then on followed: a new session, for how it came there nobody knows.
TEST(Frozen, FindsARobotOnItsWay) {
  OnTheMap on({});
  on.robot.place.reset();
  std::optional<ScanOutcome> outcome;
  double x = 4;
  for (; x < 14 && !outcome; x += 0.1) {
    outcome = on.scan({x, 0.3, 0}, {x - 4, 0, 0});
    on.wait();
  }
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(outcome->new_session);
  EXPECT_NEAR(outcome->pose.map_from_robot.x, x - 0.1, 0.1);
  EXPECT_NEAR(outcome->pose.map_from_robot.y, 0.3, 0.1);
  EXPECT_GE(on.frozen.counts().finds, 2);
}

TEST(Frozen, LosesARobotThatWasCarriedAway) {
  OnTheMap on({0, 0, 0});
  ASSERT_TRUE(on.scan({0.1, 0, 0}));
  Walls closet;
  add_box(closet, -0.9, -0.9, 1.1, 0.8);
  int told = 0;
  for (int i = 0; i < 8; ++i) told += on.scan({}, {30, 0, 0}, closet) ? 1 : 0;
  EXPECT_EQ(told, 0);
  EXPECT_FALSE(on.robot.place) << "after eight scans in vain it is not there";
}

// Switched off and on where it stood: its odometry begins at zero.
TEST(Frozen, TriesFirstWhereARobotWas) {
  OnTheMap on({5, 0, 0});
  ASSERT_TRUE(on.scan({5.1, 0, 0}));
  on.frozen.restart(on.robot);
  EXPECT_FALSE(on.robot.place);
  const auto outcome = on.scan({5.1, 0, 0}, {});
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(outcome->pose.matched);
  EXPECT_TRUE(outcome->new_session);
  EXPECT_NEAR(outcome->pose.map_from_robot.x, 5.1, 0.05);
}

// Nobody knows where it is, and it stands still: somebody says where, about.
struct Given : OnTheMap {
  Given() : OnTheMap(Pose{}) { robot.place.reset(); }
  DropReason give(const Pose& pose, double sigma_m = 0.5, double sigma_rad = 0.5) {
    InitialPoseEvent event;
    event.island = PatchId{0};
    event.pose = pose;
    event.sigma_m = sigma_m;
    event.sigma_rad = sigma_rad;
    return frozen.take_given(map, robot, event, options.frozen);
  }
  std::vector<LostRobot> lost() {
    return frozen.lost([&](const std::string&) { return robot.place.has_value(); }, options);
  }
};

TEST(Frozen, PutsARobotWhereItIsSaidToBeIfItsScanFitsThere) {
  Given on;
  const Pose truth{5, 0.3, 0.2};
  EXPECT_FALSE(on.scan(truth, {}));
  EXPECT_EQ(on.give({5.6, -0.2, 0.5}), DropReason::none);
  const auto outcome = on.scan(truth, {});
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(outcome->pose.matched);
  EXPECT_TRUE(outcome->new_session);
  EXPECT_NEAR(outcome->pose.map_from_robot.x, 5, 0.05);
  EXPECT_NEAR(outcome->pose.map_from_robot.yaw, 0.2, 0.02);
  EXPECT_TRUE(on.lost().empty());
}

// A hall in which things stand that did not when it was mapped, and a robot that knows nothing but scans that
// fit.
Walls changed_hall() {
  Walls walls = niched_hall();
  for (double x = 2; x < 20; x += 1.2) add_box(walls, x, 1.3, x + 0.3, 1.6);
  return walls;
}

void let_learn_that_all_fits(OnTheMap& on) {
  for (int i = 0; i < 1000; ++i) on.robot.usual_misfit.learn(0.97, on.options.usual_misfit);
}

TEST(Frozen, PutsARobotWhereItIsSaidToBeThoughSomeStandsThereThatDidNot) {
  Given on;
  let_learn_that_all_fits(on);
  const Pose truth{5, 0.3, 0.2};
  on.give({5.6, -0.2, 0.5});
  const auto outcome = on.scan(truth, {}, changed_hall());
  ASSERT_TRUE(outcome);
  EXPECT_NEAR(outcome->pose.map_from_robot.x, 5, 0.05);
}

TEST(Frozen, FindsARobotWhereSomeStandsThatDidNot) {
  OnTheMap on({});
  let_learn_that_all_fits(on);
  on.robot.place.reset();
  std::optional<ScanOutcome> outcome;
  double x = 4;
  for (; x < 14 && !outcome; x += 0.1) {
    outcome = on.scan({x, 0.3, 0}, {x - 4, 0, 0}, changed_hall());
    on.wait();
  }
  ASSERT_TRUE(outcome);
  EXPECT_NEAR(outcome->pose.map_from_robot.x, x - 0.1, 0.1);
}

// Where odometry jumps, the walls near by are not taken for its own that fit so.
TEST(Frozen, DoesNotFollowAJumpToWhereSomeStandsThatDidNot) {
  OnTheMap on({4, 0.3, 0});
  let_learn_that_all_fits(on);
  ASSERT_TRUE(on.scan({4.1, 0.3, 0}));
  EXPECT_FALSE(on.scan({4.1, 0.3, 0}, {34.1, 0.3, 0}, changed_hall()));
}

TEST(Frozen, LeavesARobotWhereItIsSaidToBeInVainAndSaysWhy) {
  Given on;
  EXPECT_EQ(on.give({11, 0, 0}, 0.3, 0.2), DropReason::none);
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(on.scan({5, 0.3, 1.5}, {})) << i;
  ASSERT_EQ(on.lost().size(), 1U);
  EXPECT_EQ(on.lost().front().why, NotFound::given_pose_misfits);
  EXPECT_FALSE(on.lost().front().placed);
}

// One that is found does not go where its scan does not fit, whoever says so.
TEST(Frozen, KeepsARobotThatIsFoundWhereAGivenPoseDoesNotFit) {
  Given on;
  on.give({5, 0.3, 0});
  ASSERT_TRUE(on.scan({5, 0.3, 0}, {}));
  on.give({11, 0, 1.5}, 0.3, 0.2);
  for (int i = 0; i < 8; ++i) {
    const auto outcome = on.scan({5, 0.3, 0}, {});
    ASSERT_TRUE(outcome) << i;
    EXPECT_NEAR(outcome->pose.map_from_robot.x, 5, 0.05);
    EXPECT_FALSE(outcome->new_session);
  }
  ASSERT_EQ(on.lost().size(), 1U);
  EXPECT_TRUE(on.lost().front().placed);
  on.utime += 60'000'000;
  on.scan({5, 0.3, 0}, {});
  EXPECT_TRUE(on.lost().empty()) << "it is told for half a minute";
}

TEST(Frozen, CarriesAGivenPoseAlongWhereTheRobotDrives) {
  Given on;
  on.give({5, 0.3, 0}, 0.1, 0.1);
  EXPECT_FALSE(on.scan({12, 0.3, 1.5}, {0, 0, 0})) << "somebody stands before its laser";
  const auto outcome = on.scan({5.4, 0.3, 0}, {0.4, 0, 0});
  ASSERT_TRUE(outcome);
  EXPECT_NEAR(outcome->pose.map_from_robot.x, 5.4, 0.05);
}

// R8 is found and stands in the hall, R9 is lost; a fixed tag hangs on the wall.
struct Sighted : Given {
  Sighted() {
    Map with_tag = mapped_hall();
    const PatchId tag = with_tag.manifold().next_id();
    with_tag.add(make_tag_patch(tag, barcode, 0), {7, 1, 0});
    with_tag.relate(odometry_relation(PatchId{7}, tag, {0, 1, 0}));
    sighted_map = with_tag;
    robots["R8"] = robots["R9"] = robot;
    robots["R8"].declaration.robot = "R8";
    robots["R8"].place = Localisation{};
    robots["R8"].place->pose = {PatchId{3}, {}};
    for (const char* name : {"R8", "R9"}) robots[name].odometry.add(event_utime, {});
  }
  // As one sees the other, in the world.
  static SightingEvent seen(const std::string& by, const Pose& from, const Eigen::Vector2d& at) {
    const Eigen::Vector2d to = inverse(from) * at;
    return {by, event_utime, barcode, to.norm(), 0.05, std::atan2(to.y(), to.x()), 0.03};
  }
  bool take(const SightingEvent& event, const std::string& target, bool is_tag) {
    return frozen.take_sighting(sighted_map, robots, event, target, is_tag, options.frozen);
  }
  void expect_found_at(const Pose& truth) {
    const auto outcome = scan(truth, {});
    ASSERT_TRUE(outcome);
    EXPECT_NEAR(outcome->pose.map_from_robot.x, truth.x, 0.15);
    EXPECT_NEAR(outcome->pose.map_from_robot.y, truth.y, 0.15);
    EXPECT_NEAR(wrap_angle(outcome->pose.map_from_robot.yaw - truth.yaw), 0, 0.03);
  }

  static constexpr std::int32_t barcode = 5;
  static constexpr std::int64_t event_utime = 50'000;
  Map sighted_map;
  std::map<std::string, Robot> robots;
};

TEST(Frozen, FindsARobotThatOneSeesWhoIsFound) {
  Sighted on;
  const Pose truth{5, 0.3, 2.2};
  EXPECT_FALSE(on.scan(truth, {}));
  EXPECT_TRUE(on.take(Sighted::seen("R8", {3, 0, 0}, {5, 0.3}), "R9", false));
  on.expect_found_at(truth);
}

TEST(Frozen, FindsARobotThatSeesOneWhoIsFound) {
  Sighted on;
  const Pose truth{5, 0.3, 2.2};
  EXPECT_FALSE(on.scan(truth, {}));
  EXPECT_TRUE(on.take(Sighted::seen("R9", truth, {3, 0}), "R8", false));
  on.expect_found_at(truth);
}

TEST(Frozen, FindsARobotThatSeesAFixedTagOfTheMap) {
  Sighted on;
  const Pose truth{5.5, -0.2, -1};
  EXPECT_FALSE(on.scan(truth, {}));
  SightingEvent unknown = Sighted::seen("R9", truth, {7, 1});
  unknown.barcode = 6;
  EXPECT_FALSE(on.take(unknown, "TAG 6", true));
  EXPECT_TRUE(on.take(Sighted::seen("R9", truth, {7, 1}), "TAG 5", true));
  on.expect_found_at(truth);
}

TEST(Frozen, BelievesNoSightingWhereTheScanDoesNotFitAndTellsNobody) {
  Sighted on;
  EXPECT_TRUE(on.take(Sighted::seen("R8", {3, 0, 0}, {12, 0.3}), "R9", false));
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(on.scan({5, 0.3, 2.2}, {})) << i;
  for (const LostRobot& lost : on.lost()) EXPECT_NE(lost.why, NotFound::given_pose_misfits);
}

TEST(Frozen, LooksForARobotBySightingsOnlyWhereOneOfTwoIsFoundAndNotAtEach) {
  Sighted on;
  SightingEvent event = Sighted::seen("R8", {3, 0, 0}, {5, 0.3});
  event.bearing_sigma_rad = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(on.take(event, "R9", false));
  event.bearing_sigma_rad = 0.03;
  EXPECT_TRUE(on.take(event, "R9", false));
  EXPECT_FALSE(on.take(event, "R9", false));
  Sighted both;
  both.robots["R9"].place = both.robots["R8"].place;
  EXPECT_FALSE(both.take(event, "R9", false));
  both.robots["R8"].place.reset();
  both.robots["R9"].place.reset();
  EXPECT_FALSE(both.take(event, "R9", false));
}

TEST(GivenPose, MustBeOnTheMap) {
  Given on;
  EXPECT_EQ(on.give({5, 60, 0}), DropReason::off_the_map);
  InitialPoseEvent event;
  event.patch = PatchId{99};
  EXPECT_EQ(read_given_pose(event, on.map).refusal, DropReason::unknown_patch);
  event.patch = PatchId{4};
  event.pose = {1, 0.5, 0};
  const GivenPoseReading reading = read_given_pose(event, on.map);
  ASSERT_TRUE(reading.pose);
  EXPECT_EQ(reading.pose->patch, PatchId{5}) << "the nearest patch, 1 m from there";
  EXPECT_NEAR(reading.pose->patch_from_object.y, 0.5, 1e-9);
}

}  // namespace
}  // namespace isthmus
