#include "server/exploration/coordinator.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/exploration/timed_way.hpp"
#include "tests/support/narrow_corridors.hpp"

namespace isthmus {
namespace {

using testing::NarrowCorridor;

/// To goals in the middle of the corridor. How near two robots came.
double drive(testing::NarrowCorridors& corridor, Coordinator& coordinator,
             const std::map<std::string, double>& to_x, int steps) {
  std::map<std::string, Eigen::Vector2d> goals;
  for (const auto& [name, x] : to_x) goals[name] = {x, 0};
  return corridor.drive(coordinator, goals, steps);
}

double x_of(const testing::NarrowCorridors& corridor, const std::string& name) {
  return corridor.place(name).x();
}

TEST(Coordinator, RobotsThatDoNotMeetGoTheirWays) {
  NarrowCorridor corridor;
  corridor.add("R1", -4, -9);
  corridor.add("R2", 4, 9);
  Coordinator coordinator;
  const auto clearances = coordinator.coordinate(corridor.planner, corridor.team);
  ASSERT_EQ(clearances.size(), 2U);
  for (const auto& [name, clearance] : clearances) {
    EXPECT_EQ(clearance.leave, Leave::go);
    EXPECT_EQ(clearance.path.size(), corridor.team.at(name).path.size());
  }
}

TEST(Coordinator, WhoStandsInTheNicheWaitsThereUntilTheOtherIsThrough) {
  NarrowCorridor corridor;
  corridor.add("R1", -4, 8);
  corridor.add("R2", 0, -8, 1.3);
  Coordinator coordinator;
  const auto clearances = coordinator.coordinate(corridor.planner, corridor.team);
  EXPECT_EQ(clearances.at("R1").leave, Leave::go);
  EXPECT_EQ(clearances.at("R2").leave, Leave::wait);
  EXPECT_GT(drive(corridor, coordinator, {{"R1", 8}, {"R2", -8}}, 60), 0.4);
  EXPECT_NEAR(x_of(corridor, "R1"), 8, 0.5);
  EXPECT_NEAR(x_of(corridor, "R2"), -8, 0.5);
}

TEST(Coordinator, WhoHasLessRightGivesWayIntoTheNicheAndThenGoesOn) {
  NarrowCorridor corridor;
  corridor.add("R1", -5, 8);
  corridor.add("R2", 1.5, -8);
  Coordinator coordinator;
  const auto clearances = coordinator.coordinate(corridor.planner, corridor.team);
  EXPECT_EQ(clearances.at("R1").leave, Leave::go);
  ASSERT_EQ(clearances.at("R2").leave, Leave::give_way);
  const Eigen::Vector2d aside = corridor.end_of(clearances.at("R2"));
  EXPECT_NEAR(aside.x(), 0, 0.5);
  EXPECT_GT(aside.y(), 0.5);
  EXPECT_GT(drive(corridor, coordinator, {{"R1", 8}, {"R2", -8}}, 80), 0.4);
  EXPECT_NEAR(x_of(corridor, "R1"), 8, 0.5);
  EXPECT_NEAR(x_of(corridor, "R2"), -8, 0.5);
}

TEST(Coordinator, WhoCannotGiveWayTakesTheRightAndTheOtherGoesAside) {
  NarrowCorridor corridor;
  corridor.add("R1", -1.5, 9.5);
  corridor.add("R2", 8, -8);  // behind it is the end of the corridor
  Coordinator coordinator;
  EXPECT_GT(drive(corridor, coordinator, {{"R1", 9.5}, {"R2", -8}}, 120), 0.4);
  EXPECT_NEAR(x_of(corridor, "R1"), 9.5, 0.5);
  EXPECT_NEAR(x_of(corridor, "R2"), -8, 0.5);
}

TEST(Coordinator, WhenSearchesHaveLookedAtEnoughRightsStayAndWhoIsStuckWaits) {
  NarrowCorridor corridor;
  corridor.add("R1", 7, 9.5);
  corridor.add("R2", 9, -8);  // behind it is the end of the corridor: R1 has to go back
  const auto stuck_with = [&](std::size_t max_squares) {
    CoordinationOptions options;
    options.max_squares = max_squares;
    const auto clearances = Coordinator(options).coordinate(corridor.planner, corridor.team);
    return std::ranges::count_if(clearances, [](const auto& one) {
      return one.second.leave == Leave::wait && one.second.path.empty();
    });
  };
  EXPECT_EQ(stuck_with(CoordinationOptions{}.max_squares), 0);
  EXPECT_GE(stuck_with(1), 1);
}

TEST(Coordinator, WhoHasNoGoalMakesRoomForOneThatHas) {
  NarrowCorridor corridor;
  corridor.add_idle("A1", 1.5);  // first by name
  corridor.add("R2", 5, -8);
  Coordinator coordinator;
  const auto clearances = coordinator.coordinate(corridor.planner, corridor.team);
  EXPECT_EQ(clearances.at("A1").leave, Leave::give_way);
  EXPECT_EQ(clearances.at("R2").leave, Leave::go);
  EXPECT_GT(drive(corridor, coordinator, {{"R2", -8}}, 60), 0.4);
  EXPECT_NEAR(x_of(corridor, "R2"), -8, 0.5);
}

TEST(Coordinator, OfThreeInARowThoseBehindMakeRoomToo) {
  NarrowCorridor corridor;
  corridor.add("R1", 6, -8);
  corridor.add_idle("R2", 1.8);
  corridor.add_idle("R3", 1);
  Coordinator coordinator;
  EXPECT_GT(drive(corridor, coordinator, {{"R1", -8}}, 100), 0.4);
  EXPECT_NEAR(x_of(corridor, "R1"), -8, 0.5);
}

TEST(Coordinator, WhoDrivesBehindAnotherFollowsIt) {
  NarrowCorridor corridor;
  corridor.add("R1", -6, 8);
  corridor.add("R2", -5, 9.5);  // ahead of the one with more right
  Coordinator coordinator;
  const auto clearances = coordinator.coordinate(corridor.planner, corridor.team);
  EXPECT_EQ(clearances.at("R1").leave, Leave::go);
  EXPECT_EQ(clearances.at("R2").leave, Leave::go);
}

TEST(Coordinator, WhoIsAbreastOfAnotherIsNotAheadOfIt) {
  testing::Walls walls;
  testing::add_box(walls, -10, -2, 10, 2);
  testing::NarrowCorridors hall(walls, {{-5, 0, 0}, {0, 0, 0}, {5, 0, 0}});
  hall.add("R1", -6, 8, 0.6);
  hall.add("R2", -5.95, 8.3, -0.6);  // their ways come together, and it is five centimetres ahead
  Coordinator coordinator;
  const auto clearances = coordinator.coordinate(hall.planner, hall.team);
  EXPECT_EQ(clearances.at("R1").leave, Leave::go);
  EXPECT_EQ(clearances.at("R2").leave, Leave::wait);
}

/// The way of a robot that goes straight to each of the points that it is cleared for.
TimedWay cleared_way(const testing::NarrowCorridors& scene, const std::string& name,
                     const Clearance& clearance) {
  std::vector<Eigen::Vector2d> points{scene.place(name)};
  for (const ManifoldPose& pose : clearance.path) points.push_back(position(scene.planner.project(pose)));
  return {points, 1};
}

/// A hall of 10 m by 6 m.
testing::NarrowCorridors hall() {
  testing::Walls walls;
  testing::add_box(walls, -5, -3, 5, 3);
  return {walls, {{-3, 0, 0}, {0, 0, 0}, {3, 0, 0}}};
}

TEST(Coordinator, TwoThatAreNearerThanTheyMayBePart) {
  testing::NarrowCorridors scene = hall();
  scene.add("R1", 0, -3.5);
  scene.add_idle("R2", -0.11, -0.44);
  scene.send("R2", {3.9, -0.44});  // beside R1, as far from it as now
  const auto clearances = Coordinator().coordinate(scene.planner, scene.team);
  EXPECT_EQ(clearances.at("R1").leave, Leave::go);
  const TimedWay way = cleared_way(scene, "R2", clearances.at("R2"));
  EXPECT_GT((way.at_m(0.3) - scene.place("R1")).norm(), 0.485) << "on a straight way .479";
}

TEST(Coordinator, WhoStandsInAnothersWayDoesNotCountOnThatToDriveOn) {
  testing::NarrowCorridors scene = hall();
  scene.add("R1", 0, -3.5);
  scene.add("R2", -0.45, 3.9, 0.15);  // nose to nose: R1 cannot drive before it is gone
  Coordinator coordinator;
  const auto clearances = coordinator.coordinate(scene.planner, scene.team);
  EXPECT_EQ(clearances.at("R1").leave, Leave::go);
  EXPECT_FALSE(clearances.at("R2").path.empty());
  EXPECT_GT(cleared_way(scene, "R2", clearances.at("R2")).nearest_m(scene.place("R1"), 0, 1e3), 0.44);
  EXPECT_GT(drive(scene, coordinator, {{"R1", -3.5}, {"R2", 3.9}}, 20), 0.4);
  EXPECT_NEAR(x_of(scene, "R1"), -3.5, 0.5);
  EXPECT_NEAR(x_of(scene, "R2"), 3.9, 0.5);
}

TEST(Coordinator, ARobotThatIsNowhereOnTheMapHasNoClearance) {
  NarrowCorridor corridor;
  corridor.team["R1"] = {{PatchId{77}, {}}, NarrowCorridor::slim, {}};
  corridor.add("R2", 4, 9);
  const auto clearances = Coordinator().coordinate(corridor.planner, corridor.team);
  EXPECT_EQ(clearances.size(), 1U);
  EXPECT_TRUE(clearances.contains("R2"));
}

}  // namespace
}  // namespace isthmus
