#include "server/engine/robot/pose_history.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace isthmus {
namespace {

constexpr std::int64_t second = 1'000'000;

PastPlace place(std::int64_t utime, const Pose& odom_from_robot, const Pose& patch_from_robot = {},
                int patch = 0, int session = 0) {
  PastPlace made;
  made.utime = utime;
  made.session = session;
  made.pose = {PatchId{patch}, patch_from_robot};
  made.odom_from_robot = odom_from_robot;
  return made;
}

// Odometry along x at 1 m/s, from second 0 to second `to`, at 10 Hz.
OdometryTrack straight(int to_s) {
  OdometryTrack track;
  for (int i = 0; i <= 10 * to_s; ++i) track.add(i * second / 10, {0.1 * i, 0, 0});
  return track;
}

TEST(PoseHistory, GivesThePlaceOfExactlyThatStamp) {
  PoseHistory history;
  PastPlace known = place(2 * second, {2, 0, 0}, {0.5, 0.25, 0.1}, 3);
  known.covariance(0, 0) = 0.5;
  history.add(place(1 * second, {1, 0, 0}), {});
  history.add(known, {});
  history.add(place(3 * second, {3, 0, 0}), {});
  const auto found = history.at(2 * second, straight(3), {}, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pose.patch, PatchId{3});
  EXPECT_EQ(found->pose.patch_from_object, known.pose.patch_from_object);
  EXPECT_EQ(found->covariance, known.covariance);
}

TEST(PoseHistory, BetweenTwoPlacesMovesTheEarlierOneByItsShareOfTheStep) {
  PoseHistory history;
  history.add(place(1 * second, {10, 5, 0}, {1, 2, 0.5 * M_PI}), {});
  history.add(place(2 * second, {11, 5.4, 0.2}, {0.6, 3, 0.5 * M_PI + 0.2}), {});
  const auto found = history.at(1'250'000, {}, {}, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->utime, 1'250'000);
  // A quarter of (1, 0.4, 0.2), in the robot's own axes.
  EXPECT_NEAR(found->pose.patch_from_object.x, 1 - 0.1, 1e-12);
  EXPECT_NEAR(found->pose.patch_from_object.y, 2 + 0.25, 1e-12);
  EXPECT_NEAR(found->pose.patch_from_object.yaw, 0.5 * M_PI + 0.05, 1e-12);
  EXPECT_NEAR(found->odom_from_robot.x, 10.25, 1e-12);
}

TEST(PoseHistory, InterpolatesAcrossTheTurnOfTheAngle) {
  PoseHistory history;
  history.add(place(1 * second, {0, 0, 3.1}, {0, 0, 3.1}), {});
  history.add(place(2 * second, {0, 0, -3.1}, {0, 0, -3.1}), {});
  const auto found = history.at(1'500'000, {}, {}, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(std::abs(found->pose.patch_from_object.yaw), M_PI, 1e-12);
}

TEST(PoseHistory, KnowsNothingBeforeItsOldestPlace) {
  PoseHistory history;
  EXPECT_TRUE(history.empty());
  EXPECT_FALSE(history.at(second, straight(3), {}, {}));
  history.add(place(2 * second, {2, 0, 0}), {});
  EXPECT_EQ(history.oldest_utime(), 2 * second);
  EXPECT_FALSE(history.at(2 * second - 1, straight(3), {}, {}));
}

TEST(PoseHistory, AfterItsNewestPlaceFollowsOdometryAndGrowsLessSure) {
  PoseHistory history;
  history.add(place(2 * second, {2, 0, 0}, {0.5, 0, 0}), {});
  const auto found = history.at(2'750'000, straight(3), {}, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->pose.patch_from_object.x, 1.25, 1e-12);
  EXPECT_GT(found->covariance(0, 0), 0);
  const auto later = history.at(3 * second, straight(3), {}, {});
  ASSERT_TRUE(later);
  EXPECT_GT(later->covariance(0, 0), found->covariance(0, 0));
}

TEST(PoseHistory, KnowsNothingBeyondOdometry) {
  PoseHistory history;
  history.add(place(2 * second, {2, 0, 0}), {});
  EXPECT_FALSE(history.at(3 * second + 1, straight(3), {}, {}));
  EXPECT_FALSE(history.at(2 * second + 1, {}, {}, {}));
}

// Between the last place of one session and the first of the next, no interpolation leads across: their
// odometry may have nothing to do with one another.
TEST(PoseHistory, DoesNotInterpolateFromOneSessionToTheNext) {
  PoseHistory history;
  history.add(place(1 * second, {1, 0, 0}, {1, 0, 0}, 0, 0), {});
  history.add(place(5 * second, {90, 0, 0}, {0, 0, 0}, 7, 1), {});
  OdometryTrack afterwards;  // cleared at the restart
  afterwards.add(5 * second, {90, 0, 0});
  EXPECT_FALSE(history.at(3 * second, afterwards, {}, {}));
  const auto found = history.at(5 * second, afterwards, {}, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->session, 1);
  EXPECT_EQ(found->pose.patch, PatchId{7});
  // While the first session's odometry is still known, it leads on from its last place.
  const auto before = history.at(2 * second, straight(3), {}, {});
  ASSERT_TRUE(before);
  EXPECT_EQ(before->session, 0);
  EXPECT_NEAR(before->pose.patch_from_object.x, 2, 1e-12);
}

TEST(PoseHistory, PlacesThatComeLateAreSortedIn) {
  PoseHistory history;
  history.add(place(1 * second, {1, 0, 0}, {1, 0, 0}), {});
  history.add(place(3 * second, {3, 0, 0}, {3, 0, 0}), {});
  history.add(place(2 * second, {2, 0, 0}, {2, 5, 0}), {});
  const auto found = history.at(2 * second, {}, {}, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pose.patch_from_object.y, 5);
  EXPECT_EQ(history.oldest_utime(), 1 * second);
}

// A robot drives for 10 s, then stands for five minutes: the drive is still known to the centimetre.
TEST(PoseHistory, AStandingRobotDoesNotDriveOutWhatItHasDriven) {
  PoseHistory history;
  std::int64_t utime = 0;
  for (int i = 0; i < 100; ++i, utime += second / 10)
    history.add(place(utime, {0.05 * i, 0, 0}, {0.05 * i, 0, 0}), {});
  for (int i = 0; i < 3000; ++i, utime += second / 10) history.add(place(utime, {5, 0, 0}, {5, 0, 0}), {});
  EXPECT_EQ(history.oldest_utime(), 0);
  const auto found = history.at(4'050'000, {}, {}, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->pose.patch_from_object.x, 2.025, 0.01);
}

// Ten minutes at ten scans a second, for a robot that comes back from a radio shadow as long.
TEST(PoseHistory, KnowsTenMinutesOfARobotThatScansFast) {
  PoseHistory history;
  for (int i = 0; i < 6000; ++i) {
    const double x = 0.06 * i;
    history.add(place(i * second / 10, {x, 0, 0}, {x, 0, 0}), {});
  }
  EXPECT_EQ(history.oldest_utime(), 0);
  for (const std::int64_t utime : {1 * second + 50'000, 100 * second + 30'000, 599 * second}) {
    const auto found = history.at(utime, {}, {}, {});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->pose.patch_from_object.x, 0.6e-6 * static_cast<double>(utime), 1e-9);
  }
}

TEST(PoseHistory, ForgetsTheOldestWhenFull) {
  PoseHistory history;
  constexpr int many = 20'000;
  for (int i = 0; i < many; ++i) history.add(place(i * second, {0.5 * i, 0, 0}, {0.5 * i, 0, 0}), {});
  EXPECT_GT(history.oldest_utime(), 10'000 * second);
  EXPECT_FALSE(history.at(10'000 * second, {}, {}, {}));
  EXPECT_TRUE(history.at((many - 2) * second, {}, {}, {}));
}

}  // namespace
}  // namespace isthmus
