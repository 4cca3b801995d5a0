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
AbsoluteErrors evaluate_team(double shift_m, int island_of_r2, const TagsToCompare& tags = {}) {
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
  return evaluate_absolute(read_trajectories(directory / "truth"), TeamTrajectories(directory / "out"), tags);
}

// Headings of π − 0.01 and −π + 0.01 are 0.02 apart.
TEST(AbsoluteError, ComparesHeadingsAcrossTheTurnOfTheAngle) {
  const TemporaryDirectory directory;
  std::string truth, map;
  for (int i = 0; i < 4; ++i) {
    truth += row(i, {i % 2 * 2.0, i / 2 * 2.0, 3.1315926});
    map += row(i, {i % 2 * 2.0, i / 2 * 2.0, -3.1315926});
  }
  directory.write("truth/R1.tum", truth);
  directory.write("out/trajectories/R1.tum", map);
  const AbsoluteErrors errors =
      evaluate_absolute(read_trajectories(directory / "truth"), TeamTrajectories(directory / "out"), {});
  ASSERT_EQ(errors.islands.size(), 1U);
  EXPECT_NEAR(errors.islands[0].team.rotation_deg.max, 0.02 * 180 / 3.1415926, 1e-2);
}

TEST(AbsoluteError, IsNoneForAMapThatIsOnlyMoved) {
  const AbsoluteErrors errors = evaluate_team(0, 0);
  ASSERT_EQ(errors.islands.size(), 1U);
  ASSERT_EQ(errors.islands[0].robots.size(), 2U);
  for (const auto& [robot, own] : errors.islands[0].robots) {
    EXPECT_EQ(own.count, 4U) << robot;
    EXPECT_NEAR(own.translation_m.rms, 0, 1e-5);
    EXPECT_NEAR(own.rotation_deg.max, 0, 1e-3);
    EXPECT_EQ(errors.missing.at(robot), 0U);
  }
  EXPECT_EQ(errors.islands[0].team.count, 8U);
}

TEST(AbsoluteError, ATeamOnOneIslandIsAlignedByOneMotion) {
  const AbsoluteErrors errors = evaluate_team(1, 0);
  const IslandErrors& island = errors.islands.at(0);
  EXPECT_NEAR(island.robots.at("R1").translation_m.mean, 0.5, 1e-4);
  EXPECT_NEAR(island.robots.at("R2").translation_m.rms, 0.5, 1e-4);
  EXPECT_NEAR(island.team.translation_m.rms, 0.5, 1e-4);
  EXPECT_NEAR(island.team.translation_m.deviation, 0, 1e-4);
}

TEST(AbsoluteError, IslandsAreAlignedEachByItsOwn) {
  const AbsoluteErrors errors = evaluate_team(1, 1);
  ASSERT_EQ(errors.islands.size(), 2U);
  EXPECT_EQ(errors.islands[1].island, 1);
  EXPECT_NEAR(errors.islands[0].team.translation_m.rms, 0, 1e-5);
  EXPECT_NEAR(errors.islands[1].team.translation_m.rms, 0, 1e-5);
}

TEST(AbsoluteError, TagsAreMovedWithTheRobotsOfTheirIsland) {
  TagsToCompare tags;
  for (const int barcode : {7, 8, 9}) tags.truth[barcode] = truth_from_map * Eigen::Vector2d(barcode, -3);
  tags.map[7] = {0, {7, -3}};
  tags.map[8] = {0, {8.3, -3.4}};
  tags.map[5] = {0, {0, 0}};  // nobody knows where it is
  const AbsoluteErrors errors = evaluate_team(0, 0, tags);
  EXPECT_EQ(errors.islands.at(0).tags, 2U);
  EXPECT_NEAR(errors.islands[0].tag_translation_m.max, 0.5, 1e-5);
  EXPECT_NEAR(errors.islands[0].tag_translation_m.mean, 0.25, 1e-5);
  EXPECT_EQ(errors.missing_tags, 1U);
}

TEST(AbsoluteError, ATagOnAnotherIslandIsJudgedThere) {
  TagsToCompare tags;
  tags.truth[7] = truth_from_map * Eigen::Vector2d(3, 0);
  tags.map[7] = {1, {4, 0}};
  const AbsoluteErrors errors = evaluate_team(1, 1, tags);
  EXPECT_EQ(errors.islands.at(0).tags, 0U);
  ASSERT_EQ(errors.islands.at(1).tags, 1U);
  EXPECT_NEAR(errors.islands[1].tag_translation_m.max, 0, 1e-5);
}

TEST(AbsoluteError, OfATruthAtAHigherRateTheNearestStampsCount) {
  const TemporaryDirectory directory;
  std::string truth;
  for (int i = 0; i <= 1000; ++i) truth += row(0.01 * i, {0.01 * i, 0, 0});
  std::string map;
  for (int i = 0; i <= 8; ++i) map += row(i, {1.0 * i, 0, 0});
  directory.write("truth/R1.tum", truth);
  directory.write("out/trajectories/R1.tum", map);
  const AbsoluteErrors errors =
      evaluate_absolute(read_trajectories(directory / "truth"), TeamTrajectories(directory / "out"));
  EXPECT_EQ(errors.islands.at(0).team.count, 9U);
  EXPECT_NEAR(errors.islands[0].team.translation_m.max, 0, 1e-5);
  // All stamps but 0 to 0.1, 0.9 to 1.1, … 7.9 to 8.1.
  EXPECT_EQ(errors.missing.at("R1"), 1001U - 11U - 8U * 21U);
}

}  // namespace
}  // namespace isthmus
