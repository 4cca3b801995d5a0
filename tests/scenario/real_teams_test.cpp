// Recorded logs cut into the runs of several robots, with sightings made of where they truly met: the engine
// must bring them onto one island, by true sightings alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <set>
#include <sstream>
#include <tuple>

#include "server/engine/engine.hpp"
#include "server/output/output.hpp"
#include "tests/support/recorded_data.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/evaluate/relation_error.hpp"
#include "tools/import/import.hpp"

namespace isthmus {
namespace {

/// What a team's map must reach.
struct TeamGate {
  const char* set;
  int robots;
  double mean_m;  ///< of the relations between robots
};

std::ostream& operator<<(std::ostream& stream, const TeamGate& gate) { return stream << gate.set; }

constexpr TeamGate team_gates[] = {
    {"fr079-3", 3, 0.055}, {"intel-2", 2, 0.03}, {"intel-2-double", 2, 0.03}, {"intel-4", 4, 0.03}};

/// Stamp, observer and barcode name a sighting.
using SightingName = std::tuple<std::int64_t, std::string, int>;

/// Of outliers.csv: row,utime_us,observer,barcode,…
std::set<SightingName> false_sightings(const std::string& file) {
  std::set<SightingName> names;
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::stringstream fields(line);
    std::string row, utime, observer, barcode;
    std::getline(fields, row, ',');
    std::getline(fields, utime, ',');
    std::getline(fields, observer, ',');
    std::getline(fields, barcode, ',');
    std::ranges::transform(observer, observer.begin(), [](unsigned char c) { return std::toupper(c); });
    names.emplace(std::stoll(utime), observer, std::stoi(barcode));
  }
  return names;
}

class RealTeam : public testing::TestWithParam<TeamGate> {};

TEST_P(RealTeam, MergesByTrueSightingsAloneIntoOneAccurateIsland) {
  const TeamGate& gate = GetParam();
  const std::string set = data_directory() + "/multi/" + gate.set + "/";
  if (!std::filesystem::exists(set)) GTEST_SKIP() << "no recorded data at " << set << " (ISTHMUS_DATA)";
  CarmenImport what;
  for (int i = 1; i <= gate.robots; ++i)
    what.logs.push_back({"R" + std::to_string(i), set + "r" + std::to_string(i) + ".clf.gz"});
  what.robots_csv = set + "robots.csv";
  what.sightings_csv = set + "sightings_with_outliers.csv";
  Engine engine;
  import_carmen(what, [&](const Event& event) { engine.handle(event); });
  engine.finish();
  const MapCopy map = engine.copy();

  EXPECT_EQ(map.graph.islands().size(), 1U);
  const std::set<SightingName> outliers = false_sightings(set + "outliers.csv");
  ASSERT_FALSE(outliers.empty());
  std::size_t false_ones = 0, true_ones = 0, true_accepted = 0;
  for (const auto& [sighting, verdict, reason, closure] : map.sightings) {
    const bool accepted = verdict == Verdict::accepted;
    if (outliers.contains({sighting.utime, sighting.robot, sighting.barcode})) {
      ++false_ones;
      EXPECT_EQ(verdict, Verdict::refused)
          << sighting.robot << " at " << sighting.utime << ": " << word(reason);
      EXPECT_NE(reason, Reason::none);
    } else {
      ++true_ones;
      true_accepted += accepted ? 1 : 0;
    }
  }
  EXPECT_EQ(false_ones, outliers.size());
  EXPECT_EQ(true_accepted, true_ones);

  const TemporaryDirectory directory;
  write_outputs(map, {}, directory / "map");
  const auto errors =
      evaluate_relations(read_team_relations(set + "relations.csv"), TeamTrajectories(directory / "map"));
  const RelationErrors& inter = errors.at("inter");
  EXPECT_EQ(inter.missing, 0U);
  EXPECT_LT(inter.translation_m.mean, gate.mean_m);
  std::printf("%s: %zu of %zu true sightings accepted, %zu false; between robots %.4f ± %.4f m over %zu\n",
              gate.set, true_accepted, true_ones, false_ones, inter.translation_m.mean,
              inter.translation_m.deviation, inter.count);
}

INSTANTIATE_TEST_SUITE_P(Sets, RealTeam, testing::ValuesIn(team_gates), [](const auto& test) {
  std::string name = test.param.set;
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace isthmus
