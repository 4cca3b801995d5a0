#include "tools/simulate/truth/truth_files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/support/temporary_directory.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

std::vector<std::string> lines_of(const std::string& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(TruthRelations, AgreeWithTheTruePoses) {
  const SimulatedRun run = simulate(load_scenario("office"), 1);
  std::map<std::pair<std::string, std::int64_t>, Pose> poses;
  for (const RobotTruth& robot : run.truth) {
    for (const TruePose& pose : robot.poses) poses[{robot.robot, pose.utime}] = pose.world_from_robot;
  }
  std::size_t intra = 0, inter = 0, long_term = 0;
  for (const ScanRelation& r : sample_relations(run.truth, 1)) {
    const Pose a = poses.at({r.robot1, r.utime1}), b = poses.at({r.robot2, r.utime2});
    const Pose error = ominus(b, a * r.pose);
    EXPECT_LT(std::hypot(error.x, error.y), 1e-9);
    (r.robot1 == r.robot2 ? intra : inter) += 1;
    long_term += r.robot1 == r.robot2 && r.utime2 - r.utime1 >= 30'000'000 ? 1U : 0U;
  }
  EXPECT_GT(intra, 500U);
  EXPECT_GT(inter, 500U);
  EXPECT_GT(long_term, 200U);
}

TEST(TruthRelations, NoneSpansACarry) {
  const SimulatedRun run = simulate(load_scenario("kidnap"), 1);
  std::map<std::int64_t, std::size_t> stretch;
  for (const TruePose& pose : run.truth.at(0).poses) stretch[pose.utime] = pose.stretch;
  for (const ScanRelation& r : sample_relations(run.truth, 1)) {
    if (r.robot1 == "R1" && r.robot2 == "R1") {
      EXPECT_EQ(stretch.at(r.utime1), stretch.at(r.utime2));
    }
  }
}

TEST(TruthFiles, AreWrittenInTheirFormats) {
  const TemporaryDirectory directory;
  const Scenario scenario = load_scenario("office", {"duration_s=60", "false_sightings=0.3"});
  const SimulatedRun run = simulate(scenario, 1);
  write_truth(scenario, run, sample_relations(run.truth, 1), directory / "truth");

  const auto poses = lines_of(directory / "truth/R1.tum");
  ASSERT_EQ(poses.size(), run.truth[0].poses.size());
  std::istringstream row(poses[10]);
  double t = 0, x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 0;
  ASSERT_TRUE(row >> t >> x >> y >> z >> qx >> qy >> qz >> qw);
  const TruePose& truth = run.truth[0].poses[10];
  EXPECT_NEAR(t, static_cast<double>(truth.utime) * 1e-6, 1e-5);
  EXPECT_NEAR(x, truth.world_from_robot.x, 1e-6);
  EXPECT_NEAR(2 * std::atan2(qz, qw), truth.world_from_robot.yaw, 1e-6);

  EXPECT_EQ(lines_of(directory / "truth/relations.csv").at(0),
            "robot1,utime1_us,robot2,utime2_us,x_m,y_m,yaw_rad,kind");
  const auto outliers = lines_of(directory / "truth/outliers.csv");
  EXPECT_EQ(outliers.at(0), "row,utime_us,observer,barcode,kind,true_barcode,true_range_m,true_bearing_rad");
  EXPECT_EQ(outliers.size(), 1 + run.false_sightings.size());
  const auto walls = lines_of(directory / "truth/floor_plan.csv");
  EXPECT_EQ(walls.at(0), "ax_m,ay_m,bx_m,by_m");
  EXPECT_EQ(walls.size(), 1 + scenario.plan.segments.size());
  EXPECT_EQ(lines_of(directory / "truth/floor_plan.png").at(0).substr(1, 3), "PNG");
}

TEST(TruthFiles, UnwritablePlaceIsNamed) {
  const TemporaryDirectory directory;
  directory.write("file", "");
  const Scenario scenario = load_scenario("hall", {"duration_s=1"});
  const std::string error =
      error_of([&] { write_truth(scenario, simulate(scenario, 1), {}, directory / "file/truth"); });
  EXPECT_NE(error.find("file/truth"), std::string::npos) << error;
}

}  // namespace
}  // namespace isthmus
