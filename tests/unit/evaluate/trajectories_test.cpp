#include "tools/evaluate/trajectories.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

TEST(Trajectory, TheNearestRowCountsAndTheEarlierOfTwo) {
  const Trajectory trajectory({{3'000'000, {3, 0, 0}}, {1'000'000, {1, 0, 0}}, {1'200'000, {1.2, 0, 0}}});
  const auto x_at = [&](std::int64_t utime) { return trajectory.nearest(utime, 100'000)->map_from_robot.x; };
  EXPECT_EQ(x_at(1'090'000), 1);
  EXPECT_EQ(x_at(1'100'000), 1);
  EXPECT_EQ(x_at(1'110'000), 1.2);
  EXPECT_EQ(x_at(1'200'000), 1.2);
}

TEST(Trajectory, ATenthOfASecondIsNearEnoughAndNoMore) {
  const Trajectory trajectory({{1'000'000, {}}, {3'000'000, {}}});
  EXPECT_TRUE(trajectory.nearest(900'000, 100'000));
  EXPECT_TRUE(trajectory.nearest(3'100'000, 100'000));
  EXPECT_FALSE(trajectory.nearest(899'999, 100'000));
  EXPECT_FALSE(trajectory.nearest(3'100'001, 100'000));
  EXPECT_FALSE(trajectory.nearest(2'000'000, 100'000));
  EXPECT_FALSE(Trajectory({}).nearest(0, 100'000));
}

TEST(Trajectory, OfRowsWithOneStampTheFirstCounts) {
  const Trajectory trajectory({{1'000'000, {1, 0, 0}}, {1'000'000, {2, 0, 0}}});
  EXPECT_EQ(trajectory.nearest(1'000'000, 0)->map_from_robot.x, 1);
  EXPECT_EQ(trajectory.nearest(1'050'000, 100'000)->map_from_robot.x, 1);
}

TEST(Trajectory, TumRowsAreReadWithTheirYaw) {
  const TemporaryDirectory directory;
  const Trajectory trajectory = read_tum(directory.write(
      "r.tum",
      "# timestamp tx ty tz qx qy qz qw\n1.250000 2 3 0 0 0 0.7071067811865476 0.7071067811865476\n"));
  ASSERT_EQ(trajectory.rows().size(), 1U);
  EXPECT_EQ(trajectory.rows()[0].utime, 1'250'000);
  EXPECT_EQ(trajectory.rows()[0].map_from_robot.x, 2);
  EXPECT_EQ(trajectory.rows()[0].map_from_robot.y, 3);
  EXPECT_NEAR(trajectory.rows()[0].map_from_robot.yaw, std::numbers::pi / 2, 1e-12);
}

TEST(Trajectory, ABadRowNamesFileAndLine) {
  const TemporaryDirectory directory;
  for (const char* row : {"1 2 3 0 0 0 0", "1 2 3 0 0 0 0 1 9", "x 2 3 0 0 0 0 1", "1 nan 3 0 0 0 0 1"}) {
    const std::string file = directory.write("r.tum", std::string("1 2 3 0 0 0 0 1\n") + row + "\n");
    EXPECT_EQ(error_of([&] { read_tum(file); }), file + ":2: expected 'timestamp tx ty tz qx qy qz qw'")
        << row;
  }
}

TEST(TeamTrajectories, TheIslandComesFromTheSessionOfThePose) {
  const TemporaryDirectory directory;
  directory.write("trajectories/R1.tum", "1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n5 5 0 0 0 0 0 1\n");
  directory.write("robots.csv", "robot,island,from_s,to_s\nR1,0,1.000000,2.000000\nR1,3,5.000000,5.000000\n");
  const TeamTrajectories team(directory / "");
  EXPECT_EQ(team.pose("R1", 1'000'000)->island, 0);
  EXPECT_EQ(team.pose("R1", 2'050'000)->island, 0);
  EXPECT_EQ(team.pose("R1", 5'000'000)->island, 3);
  EXPECT_FALSE(team.pose("R1", 3'500'000));
  EXPECT_FALSE(team.pose("R2", 1'000'000));
}

TEST(TeamTrajectories, RobotsStandInTheOrderInWhichTheyCame) {
  const TemporaryDirectory directory;
  for (const char* robot : {"r1", "r2", "r3", "r4"})
    directory.write(std::string("trajectories/") + robot + ".tum", "1 1 0 0 0 0 0 1\n");
  directory.write("robots.csv", "robot,island,from_s,to_s\nr3,0,1,1\nr1,0,2,2\nr3,1,3,3\nr4,0,4,4\n");
  EXPECT_EQ(TeamTrajectories(directory / "").robots(), (std::vector<std::string>{"R3", "R1", "R4", "R2"}));
}

TEST(TeamTrajectories, APoseWithoutASessionOrIslandIsNone) {
  const TemporaryDirectory directory;
  directory.write("trajectories/R1.tum", "1 1 0 0 0 0 0 1\n9 2 0 0 0 0 0 1\n");
  directory.write("robots.csv", "robot,island,from_s,to_s\nR1,,1,1\n");
  const TeamTrajectories team(directory / "");
  EXPECT_FALSE(team.pose("R1", 1'000'000));
  EXPECT_FALSE(team.pose("R1", 9'000'000));
}

TEST(TeamTrajectories, WithoutARobotTableAllIsOneIsland) {
  const TemporaryDirectory directory;
  directory.write("trajectories/r1.tum", "1 1 0 0 0 0 0 1\n");
  EXPECT_EQ(TeamTrajectories(directory / "").pose("R1", 1'000'000)->island, 0);
}

TEST(TeamTrajectories, ADirectoryWithoutTrajectoriesIsAnError) {
  const TemporaryDirectory directory;
  EXPECT_NE(error_of([&] { TeamTrajectories team(directory / ""); }).find("No such file"), std::string::npos);
  directory.write("trajectories/note.txt", "");
  EXPECT_NE(error_of([&] { TeamTrajectories team(directory / ""); }).find("no trajectories"),
            std::string::npos);
}

}  // namespace
}  // namespace isthmus
