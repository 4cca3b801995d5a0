#include "server/engine/sightings/placing.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

constexpr std::int64_t second_us = 1'000'000;

/// A robot that was on a patch, a metre further each second, from the tenth to the twentieth.
Robot driven_on(PatchId patch) {
  Robot robot;
  robot.declared = true;
  for (int s = 10; s <= 20; ++s) {
    const Pose pose{1.0 * s, 0, 0};
    robot.odometry.add(s * second_us, pose);
    robot.history.add({s * second_us, 0, {patch, pose}, Eigen::Matrix3d::Zero(), pose}, {});
  }
  return robot;
}

std::map<std::string, Robot> two_driven_robots() {
  return {{"R1", driven_on(PatchId{0})}, {"R2", driven_on(PatchId{1})}};
}

Evidence seen_at(double seconds, const std::string& target = "R2") {
  Evidence evidence;
  evidence.sighting.robot = "R1";
  evidence.sighting.utime = static_cast<std::int64_t>(seconds * 1e6);
  evidence.sighting.barcode = 50;
  evidence.target = target;
  evidence.is_tag = target == "TAG 50";
  return evidence;
}

Placing placed(Evidence& evidence, bool waited, const std::map<std::int32_t, PatchId>& tags = {}) {
  return place_on_manifold(two_driven_robots(), tags, waited, evidence, {});
}

TEST(Placing, PutsBothRobotsWhereTheyWereAtThatTime) {
  Evidence evidence = seen_at(12);
  EXPECT_EQ(placed(evidence, false).state, Placing::State::placed);
  EXPECT_EQ(evidence.observer.pose.patch, PatchId{0});
  EXPECT_NEAR(evidence.observer.pose.patch_from_object.x, 12, 1e-9);
  ASSERT_TRUE(evidence.target_place);
  EXPECT_EQ(evidence.target_place->pose.patch, PatchId{1});
  EXPECT_NEAR(evidence.target_place->pose.patch_from_object.x, 12, 1e-9);
}

TEST(Placing, OfATagIsInTheOriginOfItsPatchOnceItHasOne) {
  Evidence evidence = seen_at(12, "TAG 50");
  EXPECT_EQ(placed(evidence, false).state, Placing::State::placed);
  EXPECT_FALSE(evidence.target_place);
  EXPECT_EQ(placed(evidence, false, {{50, PatchId{7}}}).state, Placing::State::placed);
  ASSERT_TRUE(evidence.target_place);
  EXPECT_EQ(evidence.target_place->pose.patch, PatchId{7});
  EXPECT_EQ(evidence.target_place->pose.patch_from_object, Pose{});
}

TEST(Placing, WaitsForWhatIsToComeUntilItHasWaitedEnough) {
  Evidence evidence = seen_at(25);
  EXPECT_EQ(placed(evidence, false).state, Placing::State::waits);
  const Placing late = placed(evidence, true);
  EXPECT_EQ(late.state, Placing::State::impossible);
  EXPECT_EQ(late.reason, Reason::stamp_in_future);
}

TEST(Placing, OfATimeBeforeTheFirstScanIsImpossibleAtOnce) {
  Evidence evidence = seen_at(5);
  const Placing placing = placed(evidence, false);
  EXPECT_EQ(placing.state, Placing::State::impossible);
  EXPECT_EQ(placing.reason, Reason::before_first_scan);
}

TEST(Placing, OfARobotThatThereIsNotIsImpossible) {
  Evidence evidence = seen_at(12, "R9");
  const Placing placing = placed(evidence, false);
  EXPECT_EQ(placing.state, Placing::State::impossible);
  EXPECT_EQ(placing.reason, Reason::unknown_robot);
}

TEST(Placing, OfARobotWithoutAScanWaitsAndIsThenImpossible) {
  std::map<std::string, Robot> robots = two_driven_robots();
  robots["R2"] = {};
  Evidence evidence = seen_at(12);
  EXPECT_EQ(place_on_manifold(robots, {}, false, evidence, {}).state, Placing::State::waits);
  EXPECT_EQ(place_on_manifold(robots, {}, true, evidence, {}).reason, Reason::before_first_scan);
}

}  // namespace
}  // namespace isthmus
