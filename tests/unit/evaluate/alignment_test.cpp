#include "tools/evaluate/alignment.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

std::string row(double t, const Pose& p) {
  return std::to_string(t) + " " + std::to_string(p.x) + " " + std::to_string(p.y) + " 0 0 0 " +
         std::to_string(std::sin(p.yaw / 2)) + " " + std::to_string(std::cos(p.yaw / 2)) + "\n";
}

const Pose truth_from_map = {3, -2, 2.5};

TEST(Alignment, FindsTheMotionBetweenTwoFrames) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 5; ++i) {
    const Pose map_from_robot = {1.0 * i, 0.3 * i * i, 0.1 * i};
    pairs.push_back({truth_from_map * map_from_robot, map_from_robot});
  }
  const Pose found = align(pairs);
  EXPECT_NEAR(found.x, truth_from_map.x, 1e-12);
  EXPECT_NEAR(found.y, truth_from_map.y, 1e-12);
  EXPECT_NEAR(found.yaw, truth_from_map.yaw, 1e-12);
}

/// Two robots on a square each; R2 is misplaced by `shift_m` within the map.
std::vector<AbsoluteErrors> evaluate_team(double shift_m, int island_of_r2) {
  const TemporaryDirectory directory;
  std::string truth1, truth2, map1, map2;
  for (int i = 0; i < 4; ++i) {
    const Pose robot1 = {i % 2 * 2.0, i / 2 * 2.0, 0.5 * i};
    const Pose robot2 = {6 + i % 2 * 2.0, i / 2 * 2.0, 0};
    truth1 += row(i, truth_from_map * robot1);
    truth2 += row(i, truth_from_map * robot2);
    map1 += row(i, robot1);
    map2 += row(i, {robot2.x + shift_m, robot2.y, robot2.yaw});
  }
  directory.write("truth/R1.tum", truth1);
  directory.write("truth/R2.tum", truth2);
  directory.write("out/trajectories/R1.tum", map1);
  directory.write("out/trajectories/R2.tum", map2);
  directory.write("out/robots.csv",
                  "robot,island,from_s,to_s\nR1,0,0,3\nR2," + std::to_string(island_of_r2) + ",0,3\n");
  return evaluate_absolute(read_trajectories(directory / "truth"), TeamTrajectories(directory / "out"));
}

TEST(AbsoluteError, IsNoneForAMapThatIsOnlyMoved) {
  const auto errors = evaluate_team(0, 0);
  ASSERT_EQ(errors.size(), 2U);
  for (const AbsoluteErrors& e : errors) {
    EXPECT_EQ(e.count, 4U);
    EXPECT_NEAR(e.rms_m, 0, 1e-5);
    EXPECT_NEAR(e.rotation_deg.max, 0, 1e-3);
  }
}

TEST(AbsoluteError, ATeamOnOneIslandIsAlignedByOneMotion) {
  const auto errors = evaluate_team(1, 0);
  EXPECT_NEAR(errors[0].translation_m.mean, 0.5, 1e-4);
  EXPECT_NEAR(errors[1].rms_m, 0.5, 1e-4);
}

TEST(AbsoluteError, IslandsAreAlignedEachByItsOwn) {
  const auto errors = evaluate_team(1, 1);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[1].island, 1);
  EXPECT_NEAR(errors[0].rms_m, 0, 1e-5);
  EXPECT_NEAR(errors[1].rms_m, 0, 1e-5);
}

}  // namespace
}  // namespace isthmus
