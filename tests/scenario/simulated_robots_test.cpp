#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>

#include "relations/confidence.hpp"
#include "tests/scenario/simulated_maps.hpp"

namespace isthmus {
namespace {

double matched_share(const MapCopy& map) {
  return static_cast<double>(map.counters.scans_matched) / static_cast<double>(map.counters.scans);
}

// The office's demo: four robots that start at unknown places build four islands.
TEST(SimulatedRobots, FourRobotsMergeTheirIslands) {
  const SimulatedMap office = map_scenario("office");
  EXPECT_EQ(office.map.graph.islands().size(), 1U);
  for (const char* robot : {"R1", "R2", "R3", "R4"}) {
    EXPECT_EQ(sessions_of(office.map, robot).size(), 1U) << robot;
  }
  EXPECT_GT(matched_share(office.map), 0.98);
  const TrajectoryError error = judge_trajectories(office);
  std::printf("office: mean error %.4f m, %.5f rad, at most %.3f m\n", error.mean_m, error.mean_rad,
              error.max_m);
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
  std::printf("kidnap: mean error %.4f m, at most %.3f m\n", error.mean_m, error.max_m);
  EXPECT_LT(error.mean_m, 0.05);
  EXPECT_LT(error.max_m, 0.5);
}

// While odometry stands still and scans say otherwise, and when it jumps, the map stays whole; afterwards the
// robot is where it should be.
TEST(SimulatedRobots, FrozenOdometryIsSurvived) {
  const SimulatedMap freeze = map_scenario("freeze");
  EXPECT_EQ(sessions_of(freeze.map, "R1").size(), 1U);
  EXPECT_EQ(freeze.map.graph.islands().size(), 1U);
  const TrajectoryError error = judge_trajectories(freeze);
  const std::int64_t end_of_freezes = freeze.run.events.front().receive_utime + 64'000'000;
  const TrajectoryError after = judge_trajectories(freeze, end_of_freezes);
  std::printf("freeze: mean error %.4f m, at most %.3f m; after the last freeze %.4f, %.3f m\n", error.mean_m,
              error.max_m, after.mean_m, after.max_m);
  EXPECT_LT(error.mean_m, 0.05);
  EXPECT_GT(after.relations, 20U);
  EXPECT_LT(after.max_m, 0.3);
}

// Two patches of a map and what is said and true of one seen from the other, along and across the corridor
// (the world's x and y axes).
struct CorridorPair {
  Eigen::Vector2d sigma;  // along, across
  Eigen::Vector2d error;
  double nees = 0;  // for each degree of freedom
};

PatchId patch_nearest(const MapCopy& map, const std::map<std::int64_t, Pose>& truth, double x_m) {
  const auto off = [&](const PatchPtr& patch) { return std::abs(truth.at(patch->utime).x - x_m); };
  return (*std::ranges::min_element(map.patches, {}, off))->id;
}

CorridorPair corridor_pair(const SimulatedMap& corridor, double from_x_m, double to_x_m) {
  const MapCopy& map = corridor.map;
  std::map<std::int64_t, Pose> truth;
  for (const TruePose& pose : corridor.run.truth.at(0).poses) truth[pose.utime] = pose.world_from_robot;
  const PatchId a = patch_nearest(map, truth, from_x_m), b = patch_nearest(map, truth, to_x_m);
  const auto ia = static_cast<std::size_t>(a.value), ib = static_cast<std::size_t>(b.value);
  const Pose true_a = truth.at(map.patches[ia]->utime), true_b = truth.at(map.patches[ib]->utime);
  const auto covariances = exact_relative_covariances(map.graph, map.poses, a, std::vector<PatchId>{b});
  if (covariances.size() != 1) throw std::runtime_error("no covariance between two patches of the corridor");

  const Eigen::Vector3d error =
      wrapped_difference(ominus(map.poses[ib], map.poses[ia]), ominus(true_b, true_a));
  const Eigen::Rotation2Dd world_from_a(true_a.yaw);
  const Eigen::Matrix2d position =
      world_from_a * covariances[0].topLeftCorner<2, 2>() * world_from_a.inverse();
  return {position.diagonal().cwiseSqrt(), world_from_a * error.head<2>(),
          error.dot(covariances[0].inverse() * error) / 3};
}

// Nothing tells how far along a featureless corridor a robot is but its odometry: the covariance must say so.
TEST(SimulatedRobots, FeaturelessCorridorIsUncertainAlongAndCertainAcross) {
  double nees = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const SimulatedMap corridor = map_scenario("corridor", {}, seed);
    ASSERT_EQ(corridor.map.graph.islands().size(), 1U);
    const CorridorPair far = corridor_pair(corridor, 15, 45);
    std::printf("corridor, 30 m apart: sigma %.3f m along, %.3f m across; error %.3f, %.3f; NEES %.2f\n",
                far.sigma.x(), far.sigma.y(), far.error.x(), far.error.y(), far.nees);
    EXPECT_LT(std::abs(far.error.x()), 4 * far.sigma.x());
    nees += far.nees / 3;
    // Over a short way, yaw has not yet made the position across as uncertain as that along.
    const CorridorPair near = corridor_pair(corridor, 15, 18);
    std::printf("corridor, 3 m apart: sigma %.4f m along, %.4f m across\n", near.sigma.x(), near.sigma.y());
    EXPECT_GT(near.sigma.x(), 1.4 * near.sigma.y());
  }
  EXPECT_LT(nees, 4);
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
              error.max_m);
  EXPECT_GT(matched_share(hard.map), 0.95);
  EXPECT_EQ(sessions_of(hard.map, "R1").size(), 1U);
  EXPECT_EQ(sessions_of(hard.map, "R2").size(), 1U);
  EXPECT_LT(error.mean_m, 0.10);
}

}  // namespace
}  // namespace isthmus
