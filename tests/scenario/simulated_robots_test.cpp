#include <Eigen/LU>

#include "relations/confidence.hpp"
#include "tests/scenario/simulated_maps.hpp"

namespace isthmus {
namespace {

double matched_share(const MapCopy& map) {
  return static_cast<double>(map.counters.scans_matched) / static_cast<double>(map.counters.scans);
}

// The office's demo: four robots that start at unknown places build four islands.
TEST(SimulatedRobots, FourRobotsBuildFourIslands) {
  const SimulatedMap office = map_scenario("office");
  EXPECT_EQ(office.map.graph.islands().size(), 4U);
  std::set<IslandId> islands;
  for (const char* robot : {"R1", "R2", "R3", "R4"}) {
    EXPECT_EQ(islands_of(office.map, robot).size(), 1U) << robot;
    EXPECT_EQ(sessions_of(office.map, robot).size(), 1U) << robot;
    islands.merge(islands_of(office.map, robot));
  }
  EXPECT_EQ(islands.size(), 4U);
  EXPECT_GT(matched_share(office.map), 0.98);
  const TrajectoryError error = judge_trajectories(office);
  std::printf("office: mean error %.4f m, %.5f rad, at most %.3f m\n", error.mean_m, error.mean_rad,
              error.most_m);
  EXPECT_EQ(error.missing, 0U);
  EXPECT_LT(error.mean_m, 0.05);
  EXPECT_LT(error.mean_rad, 0.01);
}

TEST(SimulatedRobots, SightingsAreKeptForMerging) {
  const SimulatedMap office = map_scenario("office", {"duration_s=60"});
  EXPECT_GT(office.map.counters.sightings, 20);
  EXPECT_EQ(office.map.sightings.size(), static_cast<std::size_t>(office.map.counters.sightings));
}

// R1 is carried to another part of the building, and its odometry restarts.
TEST(SimulatedRobots, KidnappedRobotStartsANewIslandAndLeavesTheOldOneUnharmed) {
  const SimulatedMap kidnap = map_scenario("kidnap");
  EXPECT_EQ(sessions_of(kidnap.map, "R1").size(), 2U);
  EXPECT_EQ(islands_of(kidnap.map, "R1").size(), 2U);
  EXPECT_EQ(sessions_of(kidnap.map, "R2").size(), 1U);
  const TrajectoryError error = judge_trajectories(kidnap);
  std::printf("kidnap: mean error %.4f m, at most %.3f m\n", error.mean_m, error.most_m);
  EXPECT_LT(error.mean_m, 0.05);
  EXPECT_LT(error.most_m, 0.5);
}

TEST(SimulatedRobots, FrozenOdometryIsSurvived) {
  const SimulatedMap freeze = map_scenario("freeze");
  EXPECT_EQ(sessions_of(freeze.map, "R1").size(), 1U);
  EXPECT_EQ(freeze.map.graph.islands().size(), 1U);
  const TrajectoryError error = judge_trajectories(freeze);
  std::printf("freeze: mean error %.4f m, at most %.3f m\n", error.mean_m, error.most_m);
  EXPECT_LT(error.mean_m, 0.05);
  EXPECT_LT(error.most_m, 0.5);
}

// Nothing tells how far along a featureless corridor a robot is but its odometry: the covariance must say so.
TEST(SimulatedRobots, FeaturelessCorridorIsUncertainAlongAndCertainAcross) {
  const SimulatedMap corridor = map_scenario("corridor");
  const MapCopy& map = corridor.map;
  ASSERT_EQ(map.graph.islands().size(), 1U);
  const RobotTruth& truth = corridor.run.truth.at(0);
  std::map<std::int64_t, Pose> true_pose;
  for (const TruePose& pose : truth.poses) true_pose[pose.utime] = pose.world_from_robot;
  const auto at_x = [&](double x_m) {
    std::size_t best = 0;
    double nearest = 1e9;
    for (std::size_t i = 0; i < map.patches.size(); ++i) {
      const double off = std::abs(true_pose.at(map.patches[i]->utime).x - x_m);
      if (off < nearest) best = i;
      nearest = std::min(nearest, off);
    }
    return PatchId{static_cast<std::int32_t>(best)};
  };
  const PatchId here = at_x(15), there = at_x(45);
  const auto covariances =
      exact_relative_covariances(map.graph, map.poses, here, std::vector<PatchId>{there});
  ASSERT_EQ(covariances.size(), 1U);
  // The corridor runs along the world's x axis, at -yaw in the patch's own frame.
  const Eigen::Vector2d along =
      rotate(-true_pose.at(map.patches[static_cast<std::size_t>(here.value)]->utime).yaw, {1, 0});
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Matrix2d position = covariances[0].topLeftCorner<2, 2>();
  const double sigma_along = std::sqrt(along.dot(position * along));
  std::printf("corridor: sigma along 30 m of it %.3f m, across %.3f m\n", sigma_along,
              std::sqrt(across.dot(position * across)));

  const Pose estimate = ominus(map.poses[static_cast<std::size_t>(there.value)],
                               map.poses[static_cast<std::size_t>(here.value)]);
  const Pose actual = ominus(true_pose.at(map.patches[static_cast<std::size_t>(there.value)]->utime),
                             true_pose.at(map.patches[static_cast<std::size_t>(here.value)]->utime));
  Eigen::Vector3d error = to_vector(estimate) - to_vector(actual);
  error[2] = wrap_angle(error[2]);
  EXPECT_LT(std::abs(along.dot(error.head<2>())), 4 * sigma_along);
  const double nees = error.dot(covariances[0].inverse() * error) / 3;
  std::printf("corridor: error %.3f m along, %.3f m across, NEES per degree of freedom %.3f\n",
              along.dot(error.head<2>()), across.dot(error.head<2>()), nees);
  EXPECT_LT(nees, 5);

  // Neighbours, where the turn between them says little of what lies across: the corridor's own signature.
  const PatchId next = at_x(18);
  const auto near = exact_relative_covariances(map.graph, map.poses, here, std::vector<PatchId>{next});
  ASSERT_EQ(near.size(), 1U);
  const Eigen::Matrix2d near_position = near[0].topLeftCorner<2, 2>();
  EXPECT_GT(along.dot(near_position * along), 2 * across.dot(near_position * across));
}

TEST(SimulatedRobots, SameEventsGiveTheSameMap) {
  const SimulatedRun run = simulate(load_scenario("office", {"duration_s=90"}), 3);
  const std::string once = map_sha256(map_events(run.events));
  EXPECT_EQ(once, map_sha256(map_events(run.events)));
  EXPECT_NE(once, map_sha256(map_events(simulate(load_scenario("office", {"duration_s=90"}), 4).events)));
}

TEST(SimulatedRobots, WhatMakesRealLogsHardIsSurvived) {
  const SimulatedMap hard = map_scenario("hard");
  const TrajectoryError error = judge_trajectories(hard);
  std::printf("hard: mean error %.4f m, %.5f rad, at most %.3f m\n", error.mean_m, error.mean_rad,
              error.most_m);
  EXPECT_GT(matched_share(hard.map), 0.95);
  EXPECT_EQ(sessions_of(hard.map, "R1").size(), 1U);
  EXPECT_EQ(sessions_of(hard.map, "R2").size(), 1U);
  EXPECT_LT(error.mean_m, 0.10);
}

}  // namespace
}  // namespace isthmus
