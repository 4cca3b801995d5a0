#include "tools/simulate/campaigns/sightings/sightings.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <set>

#include "tests/support/start_utime.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

using testing::simulated_start_utime;

SightingEvent seen(const std::string& by, int barcode, double range_m, double bearing_rad) {
  return {by, simulated_start_utime + 500'000, barcode, range_m, 0.02, bearing_rad, 0.07};
}

// R1 at the origin drives along x at 1 m/s; R2 stands at (4.5, 0). Each of the readings is at R1's 0.5 m.
SimulatedRun run_with(const std::vector<SightingEvent>& sightings, const std::set<std::size_t>& spoilt) {
  SimulatedRun run;
  run.truth = {{"R1", {}}, {"R2", {}}};
  for (const std::int64_t after_us : {0, 400'000, 800'000}) {
    run.truth[0].poses.push_back(
        {simulated_start_utime + after_us, 0, {static_cast<double>(after_us) * 1e-6, 0, 0}});
    run.truth[1].poses.push_back({simulated_start_utime + after_us, 0, {4.5, 0, 0}});
  }
  run.events.push_back({simulated_start_utime, RobotEvent{"R1", simulated_start_utime, 101, {}, 0.2, false}});
  run.events.push_back({simulated_start_utime, RobotEvent{"R2", simulated_start_utime, 102, {}, 0.2, false}});
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    run.events.push_back({sightings[i].utime, sightings[i]});
    if (spoilt.contains(i)) run.false_sightings.push_back({i + 1, sightings[i], "gross", {}});
  }
  return run;
}

using enum Verdict;

SightingLog records(const std::vector<Verdict>& verdicts) {
  SightingLog all;
  for (const Verdict verdict : verdicts) all.append({{}, verdict, Reason::none, {}});
  return all;
}

TEST(JudgeSightings, CountsWhatWasAccepted) {
  const SimulatedRun run =
      run_with({seen("R1", 102, 4, 0), seen("R1", 102, 4.1, 0.1), seen("R1", 102, 5.5, 0),
                seen("R1", 102, 4, 0.6), seen("R1", 177, 4, 0), seen("R2", 101, 4, 3.14)},
               {2, 3, 4});
  const SightingScore score =
      judge_sightings(run, records({accepted, refused, accepted, waiting, refused, waiting}));
  EXPECT_EQ(score.true_ones, 3U);
  EXPECT_EQ(score.true_accepted, 1U);
  EXPECT_EQ(score.false_ones, 3U);
  EXPECT_EQ(score.false_accepted, 1U);
  EXPECT_NEAR(score.true_share(), 1.0 / 3, 1e-12);
}

TEST(JudgeSightings, SpoiltOneThatIsStillRightIsTrue) {
  const SimulatedRun run = run_with({seen("R1", 102, 4.3, 0.05), seen("R1", 102, 4.6, 0)}, {0, 1});
  const SightingScore score = judge_sightings(run, records({accepted, accepted}));
  EXPECT_EQ(score.true_accepted, 1U);
  EXPECT_EQ(score.false_accepted, 1U);
}

TEST(JudgeSightings, MissingRecordIsAnError) {
  const SimulatedRun run = run_with({seen("R1", 102, 4, 0), seen("R1", 102, 4, 0)}, {});
  EXPECT_EQ(error_of([&] { judge_sightings(run, records({accepted})); }),
            "the map has 1 records of 2 sightings");
}

// Maps of one patch each per robot, in which every robot's trajectory is known exactly, but for an offset.
MapCopy map_of(double r2_off_m, bool joined) {
  MapCopy map;
  auto rows = std::make_shared<TrajectoryStore>();
  const double x[] = {0, 5 + r2_off_m};
  for (int i = 0; i < 2; ++i) {
    const PatchId patch{i};
    map.graph.add_patch(patch);
    map.poses.push_back({x[i], 0, 0});
    map.sessions.push_back(
        {"R" + std::to_string(i + 1), i, simulated_start_utime, simulated_start_utime, patch});
    rows->append({simulated_start_utime, i, patch, {}});
    rows->append({simulated_start_utime + 1'000'000, i, patch, {1, 0, 0}});
  }
  if (joined) {
    Relation relation;
    relation.a = PatchId{0};
    relation.b = PatchId{1};
    relation.measurement = RelativePose{{5, 0, 0}, Eigen::Matrix3d::Identity()};
    map.graph.add(relation);
  }
  rows->flush();
  map.trajectory = rows;
  map.trajectory_rows = rows->size();
  return map;
}

TEST(CompareMaps, ErrorsAreOfRelationsThatBothMapsTell) {
  const std::vector<ScanRelation> intra{
      {"R1", simulated_start_utime, "R1", simulated_start_utime + 1'000'000, {1, 0, 0}},
      {"R1", simulated_start_utime, "R1", simulated_start_utime + 5'000'000, {1, 0, 0}}};
  const std::vector<ScanRelation> inter{
      {"R1", simulated_start_utime, "R2", simulated_start_utime + 50'000, {5, 0, 0}}};
  const MapCopy spoilt = map_of(0.3, true), clean = map_of(0.1, true), parted = map_of(0, false);
  const RelationComparison a = compare(intra, spoilt, clean), b = compare(inter, spoilt, clean);
  EXPECT_EQ(a.compared, 1U);
  EXPECT_EQ(a.missing, 1U);
  EXPECT_NEAR(a.mean_m, 0, 1e-12);
  EXPECT_EQ(b.compared, 1U);
  EXPECT_NEAR(b.mean_m, 0.3, 1e-12);
  EXPECT_NEAR(b.mean_clean_m, 0.1, 1e-12);
  const RelationComparison c = compare(inter, parted, clean);
  EXPECT_EQ(c.compared, 0U);
  EXPECT_EQ(c.missing, 1U);
  EXPECT_EQ(c.missing_clean, 0U);
}

TEST(RelationComparison, MeansAreWeightedByNumber) {
  RelationComparison sum{2, 1, 0, 0.3, 0.1};
  sum.add({4, 0, 2, 0.6, 0.4});
  EXPECT_EQ(sum.compared, 6U);
  EXPECT_EQ(sum.missing, 1U);
  EXPECT_EQ(sum.missing_clean, 2U);
  EXPECT_NEAR(sum.mean_m, 0.5, 1e-12);
  EXPECT_NEAR(sum.mean_clean_m, 0.3, 1e-12);
  sum.add({});
  EXPECT_NEAR(sum.mean_m, 0.5, 1e-12);
}

TEST(TrySightings, MapsTheRunWithAndWithoutFalseSightings) {
  const SightingTrial trial = try_sightings(load_scenario("meeting"), 3, 0.3);
  EXPECT_EQ(trial.seed, 3U);
  const auto all = static_cast<double>(trial.score.true_ones + trial.score.false_ones);
  EXPECT_NEAR(static_cast<double>(trial.score.false_ones) / all, 0.3, 0.12);
  EXPECT_EQ(trial.clean_score.false_ones, 0U);
  EXPECT_GT(trial.clean_score.true_ones, 60U);
  EXPECT_GE(trial.clean_islands, 1U);
  EXPECT_LE(trial.clean_islands, 2U);
  EXPECT_GT(trial.intra.compared, 100U);
  EXPECT_LT(trial.intra.mean_clean_m, 0.05);
  EXPECT_GT(trial.error_ratio(), 0.2);
}

TEST(WriteTrials, ARowForEachSeed) {
  const TemporaryDirectory directory;
  SightingTrial trial;
  trial.seed = 9;
  trial.islands = 1;
  trial.inter = {10, 2, 3, 0.5, 0.25};
  write_trials({trial, trial}, directory / "trials.csv");
  std::ifstream stream(directory / "trials.csv");
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0].substr(0, 27), "seed,islands,islands_clean,");
  EXPECT_EQ(lines[1], "9,1,0,0,0,0,0,0,0,0,0,0,0,0,10,2,3,0.5,0.25,2");
}

}  // namespace
}  // namespace isthmus
