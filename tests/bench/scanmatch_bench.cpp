#include <benchmark/benchmark.h>

#include "scanmatch/correlative.hpp"
#include "scanmatch/match_relations.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

LocalMap twelve_views() {
  LocalMap map;
  map.reference = PatchId{0};
  for (int i = 0; i < 12; ++i) {
    const Pose view{-1.5 + 0.25 * i, -1 + 0.05 * i, 0.05 * i};
    map.patches.push_back({patch_from(furnished_room(), PatchId{i}, view), view});
  }
  return map;
}

const Pose truth{0.2, -0.6, 0.3};

std::vector<ScanPoint> points() { return to_points(scan_from(furnished_room(), truth), laser_of(), {}); }

void match_180_beams_with_12_patches(benchmark::State& state) {
  const LocalMap map = twelve_views();
  const auto scan = points();
  const Prediction prediction{{0.25, -0.55, 0.32}, Eigen::Vector3d(1e4, 1e4, 1e5).asDiagonal()};
  for (auto _ : state) benchmark::DoNotOptimize(match_scan(map, scan, prediction, {}));
}
BENCHMARK(match_180_beams_with_12_patches)->Unit(benchmark::kMicrosecond);

void relations_of_a_match(benchmark::State& state) {
  const LocalMap map = twelve_views();
  const auto scan = points();
  const Match match = match_scan(map, scan, {truth, Eigen::Matrix3d::Identity()}, {});
  for (auto _ : state) benchmark::DoNotOptimize(match_relations(map, scan, match, PatchId{12}, {}, {}));
}
BENCHMARK(relations_of_a_match)->Unit(benchmark::kMicrosecond);

void search_a_window_of_1_m(benchmark::State& state) {
  const LocalMap map = twelve_views();
  const auto scan = points();
  for (auto _ : state) benchmark::DoNotOptimize(search_window(map, scan, {{0, 0, 0}, 1, 1, 0.4}, {}));
}
BENCHMARK(search_a_window_of_1_m)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isthmus
