// Recorded logs from end to end: import, replay, evaluate against the ground-truth relations of the SLAM
// benchmark (Kümmerle et al., Autonomous Robots 27, 2009). One configuration for all of them: the default.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "server/feature_maps/output/feature_files.hpp"
#include "server/wire/journal/event_log.hpp"
#include "tests/support/recorded_data.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/evaluate/relation_error.hpp"
#include "tools/import/import.hpp"
#include "tools/replay/feature_replay.hpp"
#include "tools/replay/replay.hpp"

namespace isthmus {
namespace {

constexpr double min_matched_share = 0.98;

/// What a log's map must reach.
struct Gate {
  const char* log;
  double laser_x_m;
  double mean_m;
  double mean_deg;
  double refined_m;  ///< the same after the last pass
  double refined_deg;
};

constexpr Gate gates[] = {
    {"intel", 0, 0.0160, 0.25, 0.0145, 0.225},
    {"fr079", -0.04, 0.0345, 0.49, 0.0340, 0.465},
    {"aces", 0, 0.0405, 0.38, 0.0390, 0.355},
    {"mit-csail", 0, 0.0310, 0.37, 0.0305, 0.365},
};

// The name of a test has no hyphen.
std::string name_of(const Gate& gate) {
  std::string name = gate.log;
  std::ranges::replace(name, '-', '_');
  return name;
}

// So that tests are listed by their logs.
std::ostream& operator<<(std::ostream& stream, const Gate& gate) { return stream << gate.log; }

/// Imports a log of the benchmark; the path of the event log, nothing where there is no data.
std::optional<std::string> imported(const Gate& gate, const TemporaryDirectory& directory) {
  const std::string file = data_directory() + "/bench/" + gate.log + ".clf.gz";
  if (!std::filesystem::exists(file)) return std::nullopt;
  CarmenImport what;
  what.logs = {{"R1", file}};
  what.laser_x_m = gate.laser_x_m;
  const std::string log = directory / (std::string(gate.log) + ".lcm");
  EventLogWriter writer(log);
  import_carmen(what, [&](const Event& event) { writer.write(encode(event)); });
  writer.finish();
  return log;
}

RelationErrors errors_of(const Gate& gate, const ReplayResult& result, const TemporaryDirectory& directory) {
  const std::string output = directory / gate.log;
  write_outputs(result.map(), result.cost, output);
  const auto truth = read_benchmark_relations(data_directory() + "/bench/" + gate.log + ".relations", "R1");
  return evaluate_relations(truth, TeamTrajectories(output)).at("intra");
}

class RealLog : public testing::TestWithParam<Gate> {};

TEST_P(RealLog, IsMappedAsAccuratelyAsItsGateAsksAndAlwaysTheSame) {
  const Gate& gate = GetParam();
  const TemporaryDirectory directory;
  const auto log = imported(gate, directory);
  if (!log) GTEST_SKIP() << "no recorded data at " << data_directory() << " (ISTHMUS_DATA)";
  ReplayOptions options;
  std::vector<std::string> maps;
  options.sample = [&](const Engine& engine, double) { maps.push_back(map_sha256(engine.copy())); };
  const ReplayResult first = replay(*log, options);
  const MapCopy map = first.engine.copy();

  EXPECT_EQ(first.skipped_bytes, 0);
  EXPECT_GE(static_cast<double>(map.counters.scans_matched),
            min_matched_share * static_cast<double>(map.counters.scans));
  std::int64_t accounted = map.counters.scans_matched;
  for (const auto& [reason, count] : map.counters.scans_predicted) accounted += count;
  EXPECT_EQ(accounted, map.counters.scans);
  EXPECT_EQ(map.trajectory_rows, static_cast<std::size_t>(map.counters.scans));

  const RelationErrors errors = errors_of(gate, first, directory);
  EXPECT_EQ(errors.missing, 0U);
  EXPECT_LE(errors.translation_m.mean, gate.mean_m);
  EXPECT_LE(errors.rotation_deg.mean, gate.mean_deg);
  RecordProperty("translation_mean_m", std::to_string(errors.translation_m.mean));
  RecordProperty("rotation_mean_deg", std::to_string(errors.rotation_deg.mean));
  std::printf("%s: %.4f ± %.4f m (median %.4f), %.3f ± %.3f deg\n", gate.log, errors.translation_m.mean,
              errors.translation_m.deviation, errors.translation_m.median, errors.rotation_deg.mean,
              errors.rotation_deg.deviation);

  const std::vector<std::string> maps_before = std::exchange(maps, {});
  options.refine = true;
  const ReplayResult refined = replay(*log, options);
  EXPECT_EQ(maps, maps_before) << "a second replay makes another map, in the first minute that differs";
  EXPECT_GE(refined.scans_refined, static_cast<std::size_t>(map.counters.scans) * 99 / 100);
  const RelationErrors best = errors_of(gate, refined, directory);
  EXPECT_EQ(best.missing, 0U);
  EXPECT_LE(best.translation_m.mean, gate.refined_m);
  EXPECT_LE(best.rotation_deg.mean, gate.refined_deg);
}

class RealLogBySegments : public testing::TestWithParam<Gate> {};

TEST_P(RealLogBySegments, IsAsAccurateAsItsGateAsksWhereAFilterAloneLosesItsWay) {
  const Gate& gate = GetParam();
  const TemporaryDirectory directory;
  const auto log = imported(gate, directory);
  if (!log) GTEST_SKIP() << "no recorded data at " << data_directory() << " (ISTHMUS_DATA)";
  FeatureReplayOptions options;
  options.map = feature_map_options(FeatureMapKind::segments);
  const FeatureReplayResult result = replay_features(*log, options);
  const std::string output = directory / gate.log;
  write_outputs(result.maps, result.cost, output);
  const auto truth = read_benchmark_relations(data_directory() + "/bench/" + gate.log + ".relations", "R1");
  const RelationErrors errors = evaluate_relations(truth, TeamTrajectories(output)).at("intra");
  EXPECT_EQ(errors.missing, 0U);
  EXPECT_LE(errors.translation_m.mean, gate.mean_m);
  EXPECT_LE(errors.rotation_deg.mean, gate.mean_deg);
}

INSTANTIATE_TEST_SUITE_P(Benchmark, RealLogBySegments,
                         testing::Values(Gate{"intel", 0, 0.04, 0.43, 0, 0},
                                         Gate{"fr079", -0.04, 0.065, 0.90, 0, 0},
                                         Gate{"mit-csail", 0, 0.036, 0.43, 0, 0}),
                         [](const auto& test) { return name_of(test.param); });

INSTANTIATE_TEST_SUITE_P(Benchmark, RealLog, testing::ValuesIn(gates),
                         [](const auto& test) { return name_of(test.param); });

}  // namespace
}  // namespace isthmus
