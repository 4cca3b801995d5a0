#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/exploration/coordinator.hpp"
#include "tests/support/narrow_corridors.hpp"

namespace isthmus {
namespace {

using testing::NarrowComb;

Eigen::Vector2d any_place(std::mt19937& random) {
  std::uniform_int_distribution<int> tooth(0, 4), where(0, 2);
  std::uniform_real_distribution<double> along(-9, 9), deep(1.2, NarrowComb::deep_m);
  if (where(random) == 0) return {along(random), 0};
  return {-8.0 + 4 * tooth(random), deep(random)};
}

/// Robots at random places of the comb drive to others there; who has come has no goal any more. How many
/// came.
std::size_t drive_at_random(unsigned seed, std::size_t robots, int steps) {
  static const NarrowComb empty;
  NarrowComb comb = empty;
  std::mt19937 random(seed);
  std::map<std::string, Eigen::Vector2d> goals;
  for (std::size_t i = 0; i < robots; ++i) {
    const std::string name = "R" + std::to_string(i + 1);
    do {
      const Eigen::Vector2d place = any_place(random);
      comb.add_idle(name, place.x(), place.y());
    } while (comb.nearest_m() < 0.8);
    goals[name] = any_place(random);
  }
  Coordinator coordinator;
  std::size_t came = 0;
  for (int step = 0; step < steps && !goals.empty(); ++step) {
    comb.drive(coordinator, goals, 1);
    came += std::erase_if(goals, [&](const auto& goal) {
      return (comb.place(goal.first) - goal.second).norm() < NarrowComb::arrived_m;
    });
  }
  return came;
}

TEST(CoordinatorProperty, WhereNoTwoCanPassRobotsMakeWayUntilAllHaveComeToTheirGoals) {
  constexpr unsigned runs = 20;
  for (const std::size_t robots : {2U, 3U, 4U, 6U, 8U}) {
    std::size_t came = 0;
    for (unsigned seed = 1; seed <= runs; ++seed) came += drive_at_random(seed, robots, 300);
    EXPECT_GE(static_cast<double>(came), 0.98 * static_cast<double>(robots * runs)) << robots << " robots";
  }
}

/// A hall of 10 m by 6 m.
struct Hall : testing::NarrowCorridors {
  Hall() : NarrowCorridors(walls(), {{-3, 0, 0}, {0, 0, 0}, {3, 0, 0}}) {}

 private:
  static testing::Walls walls() {
    testing::Walls walls;
    testing::add_box(walls, -5, -3, 5, 3);
    return walls;
  }
};

/// Two robots that stand so near to one another that neither drives nearer to the other by itself, and that
/// want to places of the hall. How many came there.
std::size_t part_at_random(unsigned seed) {
  static const Hall empty;
  Hall hall = empty;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-4, 4), across(-2, 2), yaw(-3.14, 3.14), apart(0.45, 0.55);
  const double angle = yaw(random), apart_m = apart(random);
  hall.add_idle("R1", 0, 0);
  hall.add_idle("R2", apart_m * std::cos(angle), apart_m * std::sin(angle));
  std::map<std::string, Eigen::Vector2d> goals;
  do {
    for (const char* name : {"R1", "R2"}) goals[name] = {along(random), across(random)};
  } while ((goals["R1"] - goals["R2"]).norm() < 1.5);
  Coordinator coordinator;
  std::size_t came = 0;
  std::map<std::string, Eigen::Vector2d> left = goals;
  for (int step = 0; step < 60 && !left.empty(); ++step) {
    hall.drive(coordinator, left, 1);
    came += std::erase_if(left, [&](const auto& goal) {
      return (hall.place(goal.first) - goal.second).norm() < Hall::arrived_m;
    });
  }
  return came;
}

TEST(CoordinatorProperty, WhoStandsNoseToNoseWithAnotherInAHallComesToItsGoalAllTheSame) {
  constexpr unsigned runs = 200;
  for (unsigned seed = 1; seed <= runs; ++seed) EXPECT_EQ(part_at_random(seed), 2U) << "seed " << seed;
}

}  // namespace
}  // namespace isthmus
