#include "tools/evaluate/relation_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

const double degree = std::numbers::pi / 180;

/// R1 at (1, 0) looking left at 1 s and at (1, 2) at 2 s; R2 at (4, 0) on island `island` at 1 s.
void write_output(const TemporaryDirectory& directory, const std::string& island) {
  const std::string left = " 0 0 0.7071067811865476 0.7071067811865476\n";
  directory.write("trajectories/R1.tum", "1.000000 1 0 0" + left + "2.000000 1 2 0" + left);
  directory.write("trajectories/R2.tum", "1.000000 4 0 0 0 0 0 1\n");
  directory.write("robots.csv", "robot,island,from_s,to_s\nR1,0,1,2\nR2," + island + ",1,1\n");
}

TEST(RelationError, IsTheComponentwiseDifferenceOfRelativePoses) {
  const TemporaryDirectory directory;
  write_output(directory, "0");
  const TeamTrajectories team(directory / "");
  // R1 moved 2 m straight ahead; the truth says 2.3 m, 0.4 m to the left and a turn of -3 degrees.
  const auto errors =
      evaluate_relations({{"R1", 1'000'000, "R1", 2'000'000, {2.3, 0.4, -3 * degree}, "intra"}}, team);
  EXPECT_EQ(errors.at("intra").count, 1U);
  EXPECT_NEAR(errors.at("intra").translation_m.mean, 0.5, 1e-12);
  EXPECT_NEAR(errors.at("intra").rotation_deg.mean, 3, 1e-12);
  EXPECT_NEAR(errors.at("intra").squared_translation_m2.mean, 0.25, 1e-12);
  EXPECT_NEAR(errors.at("intra").squared_rotation_deg2.mean, 9, 1e-9);
}

TEST(RelationError, AnglesAreWrapped) {
  const TemporaryDirectory directory;
  directory.write("trajectories/R.tum", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1 0.01\n");
  const TeamTrajectories team(directory / "");
  const double yaw = 2 * std::atan2(1, 0.01);
  const auto errors =
      evaluate_relations({{"R", 1'000'000, "R", 2'000'000, {0, 0, -std::numbers::pi}, "intra"}}, team);
  EXPECT_NEAR(errors.at("intra").rotation_deg.mean, (std::numbers::pi - yaw) / degree, 1e-6);
}

TEST(RelationError, RobotsOnDifferentIslandsHaveNoRelation) {
  const TemporaryDirectory directory;
  const std::vector<TrueRelation> truth = {
      {"R1", 1'000'000, "R2", 1'000'000, {0, -3, -90 * degree}, "inter"}};
  write_output(directory, "1");
  EXPECT_EQ(evaluate_relations(truth, TeamTrajectories(directory / "")).at("inter").missing, 1U);
  EXPECT_EQ(evaluate_relations(truth, TeamTrajectories(directory / "")).at("inter").count, 0U);
  write_output(directory, "0");
  const auto errors = evaluate_relations(truth, TeamTrajectories(directory / "")).at("inter");
  EXPECT_EQ(errors.missing, 0U);
  EXPECT_EQ(errors.count, 1U);
  EXPECT_NEAR(errors.translation_m.mean, 0, 1e-12);
  EXPECT_NEAR(errors.rotation_deg.mean, 0, 1e-9);
}

TEST(RelationError, KindsAreCountedApartAndMissingPosesWithThem) {
  const TemporaryDirectory directory;
  write_output(directory, "0");
  const auto errors = evaluate_relations({{"R1", 1'000'000, "R1", 2'000'000, {2, 0, 0}, "intra"},
                                          {"R1", 1'000'000, "R1", 7'000'000, {2, 0, 0}, "intra"},
                                          {"R1", 1'000'000, "R3", 1'000'000, {2, 0, 0}, "inter"}},
                                         TeamTrajectories(directory / ""));
  EXPECT_EQ(errors.at("intra").count, 1U);
  EXPECT_EQ(errors.at("intra").missing, 1U);
  EXPECT_EQ(errors.at("inter").count, 0U);
  EXPECT_EQ(errors.at("inter").missing, 1U);
}

TEST(Statistics, AreMeanSampleDeviationMedianAndMaximum) {
  const Statistics s = statistics({4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.deviation, std::sqrt(5.0 / 3));
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.max, 4);
  EXPECT_DOUBLE_EQ(statistics({5, 1, 2}).median, 2);
  EXPECT_DOUBLE_EQ(statistics({7}).deviation, 0);
  EXPECT_DOUBLE_EQ(statistics({}).mean, 0);
}

TEST(TrueRelations, BenchmarkFilesAreRead) {
  const TemporaryDirectory directory;
  const auto relations = read_benchmark_relations(
      directory.write("a.relations", "# note\n90.239599 90.719599 0.422330 -0.000750 0 0 0 0.017260\n"),
      "R1");
  ASSERT_EQ(relations.size(), 1U);
  EXPECT_EQ(relations[0].robot2, "R1");
  EXPECT_EQ(relations[0].utime1, 90239599);
  EXPECT_EQ(relations[0].utime2, 90719599);
  EXPECT_EQ(relations[0].from_1_to_2, (Pose{0.42233, -0.00075, 0.01726}));
  EXPECT_EQ(relations[0].kind, "intra");
}

TEST(TrueRelations, TeamFilesAreReadWithNamesInUpperCase) {
  const TemporaryDirectory directory;
  const auto relations = read_team_relations(directory.write(
      "relations.csv", "robot1,utime1_us,robot2,utime2_us,x_m,y_m,yaw_rad,kind\nr1,1,r2,2,3,4,0.5,inter\n"));
  ASSERT_EQ(relations.size(), 1U);
  EXPECT_EQ(relations[0].robot1, "R1");
  EXPECT_EQ(relations[0].robot2, "R2");
  EXPECT_EQ(relations[0].utime2, 2);
  EXPECT_EQ(relations[0].from_1_to_2, (Pose{3, 4, 0.5}));
  EXPECT_EQ(relations[0].kind, "inter");
}

TEST(TrueRelations, BadLinesNameFileAndLine) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("a.relations", "1 2 0 0 0 0 0 0\n1 2 0 0 0 0 0\n");
  EXPECT_EQ(error_of([&] { read_benchmark_relations(file, "R1"); }),
            file + ":2: wrong count of fields: expected 't1 t2 x y z roll pitch yaw'");
  const std::string other = directory.write("b.relations", "1 2 0 zero 0 0 0 0\n");
  EXPECT_EQ(error_of([&] { read_benchmark_relations(other, "R1"); }),
            other + ":1: not a number: expected 't1 t2 x y z roll pitch yaw'");
}

}  // namespace
}  // namespace isthmus
